# Reads a model of OpenSees for `hybridtest import opensees`: sources the user's script and writes the matrices of what it
# leaves, in the units of the script.
#   OpenSees import.tcl SCRIPT OUT DOFS_MAX MODES
# Writes into OUT: stiffness.mtx, mass.mtx, damping.mtx; nodes.txt with a line `node dimensions dofs` for each node;
# equations.txt with a line `equation node dof` for each row, from 0 and from 1; eigenvalues.txt, written last, with
# omega^2 of the lowest modes, empty where OpenSees finds none. Of a model that cannot be read: error.txt.
namespace eval hybridtest {
  variable out [lindex $argv 1]

  # Without it an `exit` at the end of a script would end OpenSees before the model is read.
  proc end_of_script {args} { return -code error -errorcode HYBRIDTEST_EXIT "exit" }

  proc run_script {script} {
    set ::argv {}
    set ::argc 0
    set ::argv0 $script
    cd [file dirname $script]
    rename ::exit ::hybridtest::leave
    interp alias {} ::exit {} ::hybridtest::end_of_script
    if {[catch {uplevel #0 [list source $script]} message options]} {
      if {[dict get $options -errorcode] ne "HYBRIDTEST_EXIT"} { error "[dict get $options -errorinfo]" }
    }
  }

  # Names of degrees of freedom that no other one carries along. Equations of a constrained node are first its own, in
  # order, then those that it follows.
  proc write_equations {size} {
    variable out
    set found [dict create]
    set constrained [getConstrainedNodes]
    set nodes [open $out/nodes.txt w]
    foreach node [lsort -integer [getNodeTags]] {
      set numbers [nodeDOFs $node]
      puts $nodes "$node [llength [nodeCoord $node]] [llength $numbers]"
      set following {}
      if {$node in $constrained} { set following [getConstrainedDOFs $node] }
      set position 0
      for {set dof 1} {$dof <= [llength $numbers]} {incr dof} {
        if {$dof in $following} { continue }
        set number [lindex $numbers $position]
        incr position
        if {$number >= 0} { dict lappend found $number "$node $dof" }
      }
    }
    close $nodes
    set file [open $out/equations.txt w]
    for {set number 0} {$number < $size} {incr number} {
      if {![dict exists $found $number] || [llength [dict get $found $number]] != 1} {
        error "equation $number is not that of one degree of freedom; expected nodes with rigid diaphragms, rigid links or\
               equalDOF, each degree of freedom following nodes that follow none"
      }
      puts $file "$number [lindex [dict get $found $number] 0]"
    }
    close $file
  }

  # Gives the number of rows that have an entry on the diagonal.
  proc write_matrix {name size} {
    variable out
    set entries [printA -ret]
    if {[llength $entries] != $size * $size} { error "OpenSees gives no matrix of $size by $size for the $name" }
    set lines {}
    set filled 0
    set index 0
    for {set row 1} {$row <= $size} {incr row} {
      for {set column 1} {$column <= $size} {incr column} {
        set entry [lindex $entries $index]
        incr index
        if {$entry == 0} { continue }
        lappend lines "$row $column $entry"
        if {$row == $column} { incr filled }
      }
    }
    set file [open $out/$name.mtx w]
    puts $file "%%MatrixMarket matrix coordinate real general"
    puts $file "$size $size [llength $lines]"
    if {[llength $lines] > 0} { puts $file [join $lines "\n"] }
    close $file
    return $filled
  }

  proc check_model {dofs_max} {
    set nodes [getNodeTags]
    if {[llength $nodes] == 0} {
      error "the script leaves no nodes; expected one that builds a model and does not end with `wipe`"
    }
    set dofs 0
    foreach node $nodes {
      set ndf [llength [nodeDisp $node]]
      incr dofs [expr {$ndf - [llength [getFixedDOFs $node]]}]
    }
    if {$dofs == 0} { error "no degree of freedom is free" }
    if {$dofs > $dofs_max} { error "the model has $dofs free degrees of freedom; expected at most $dofs_max" }
  }

  proc read_model {dofs_max modes} {
    check_model $dofs_max
    remove recorders
    foreach {name m c k} {stiffness 0.0 0.0 1.0 damping 0.0 1.0 0.0 mass 1.0 0.0 0.0} {
      wipeAnalysis
      constraints Transformation
      numberer Plain
      system FullGeneral
      test NormUnbalance 1.0 1
      algorithm Linear
      integrator GimmeMCK $m $c $k
      analysis Transient
      # Sets the matrix up. It cannot be solved where the matrix is singular, as a mass often is: no failure here.
      catch {analyze 1 0.0}
      set size [systemSize]
      if {$name eq "stiffness"} { write_equations $size }
      set with_mass [write_matrix $name $size]
    }
    if {$with_mass == 0} { error "no free degree of freedom has a mass" }
    # More modes than masses end OpenSees.
    set count [expr {min($modes, $with_mass)}]
    set solver [expr {$size <= 200 ? "-fullGenLapack" : "-genBandArpack"}]
    if {[catch {eigen $solver $count} found]} { set found {} }
    variable out
    set file [open $out/eigenvalues.txt w]
    foreach value $found { puts $file $value }
    close $file
  }
}
lassign $argv hybridtest::script hybridtest::out hybridtest::dofs_max hybridtest::modes
if {[catch {
  hybridtest::run_script $hybridtest::script
  hybridtest::read_model $hybridtest::dofs_max $hybridtest::modes
} hybridtest::message]} {
  set hybridtest::file [open $hybridtest::out/error.txt w]
  puts $hybridtest::file $hybridtest::message
  close $hybridtest::file
  hybridtest::leave 1
}
hybridtest::leave 0
