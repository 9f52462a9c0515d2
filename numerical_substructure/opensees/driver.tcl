# Runs inside OpenSees: reads the model of the user, imposes the displacements of its interface on request, and
# answers with the forces there. Written to a file and started by opensees_child.cpp:
#
#   OpenSees driver.tcl REQUESTS REPLIES SCRIPT MODE STEP_S TOLERANCE TRIAL_FILE NODE DOF [NODE DOF ...]
#
# MODE is `test`, or `stiffness` for a short-lived process that writes no records.
#
# REQUESTS and REPLIES are pipes; everything on them is binary, in the order of bytes of this machine. A request is a
# letter, seven bytes of nothing and one double for each degree of freedom of the interface, in the units of the script:
#   t   the forces at these displacements; the model stays as it is
#   s   the same, and the step ends there
# A reply is a letter, three bytes of nothing, the length in bytes of a text (int), four doubles (last norm of the
# convergence test, its tolerance, iterations, parts of the step), the forces, and the text:
#   r   the model stands in equilibrium; the text says what it is
#   f   forces
#   n   no algorithm converged
#   x   the script or a command failed; the text says why
#
# Forces are counted from the state in which the script leaves the model, displacements likewise.

namespace eval ::hybridtest {
  variable user_command           ;# analysis command -> as the script gave it last
  array set user_command {}
  variable halvings_max 6         ;# a step that does not converge is divided into at most 2^6 parts
  variable iterations_max 25
  variable trial_iterations 3     ;# of the last trial that converged
  variable has_trial_record 0
  variable has_ties 0             ;# nodes follow others
  variable steps 0
  variable parts 0

  # --- while the script runs ---

  proc remember {command operation} {
    variable user_command
    set user_command([lindex $command 0]) $command
  }

  # Commands of a model exist once `model` has run.
  proc remember_model {args} {
    foreach command {equalDOF equalDOF_Mixed rigidDiaphragm rigidLink} {
      if {[info commands ::$command] ne ""} { trace add execution ::$command enter ::hybridtest::remember_tie }
    }
  }

  proc remember_tie {args} { variable has_ties 1 }

  proc guard_commands {mode} {
    variable user_command
    foreach command {constraints numberer system test algorithm} {
      trace add execution $command enter ::hybridtest::remember
    }
    trace add execution model leave ::hybridtest::remember_model
    trace add execution wipeAnalysis enter {apply {args {array unset ::hybridtest::user_command}}}
    rename ::exit ::hybridtest::leave
    proc ::exit args {
      error "the script calls `exit`; a model of a substructure ends with its last line: leave `exit` out"
    }
    rename ::analyze ::hybridtest::solve
    proc ::analyze args {
      if {[llength $args] > 1 && [string is double -strict [lindex $args 1]]} {
        error "the script calls `analyze $args`, a transient analysis; the test integrates the motion in time:\
          leave the analysis out (a static one for gravity loads may stay)"
      }
      uplevel 1 [list ::hybridtest::solve {*}$args]
    }
    if {$mode eq "stiffness"} {
      # A second process beside that of a test must not write over the files of its recorders.
      rename ::recorder ::hybridtest::unused_recorder
      proc ::recorder args { return 0 }
    }
  }

  proc run_script {script} {
    variable failure
    cd [file dirname $script]
    set ::argv0 [file tail $script]
    set ::argv {}
    set ::argc 0
    if {[catch {uplevel #0 [list source [file tail $script]]} message options]} {
      set trace [dict get $options -errorinfo]
      # A command of OpenSees that fails prints its reason and raises an error without words.
      if {[string trim $message] eq ""} { set message "a command failed; its reason stands before this in the log" }
      regexp {\(file "[^\n]*" line \d+\)} $trace place
      if {![info exists place]} { set place "" }
      error "[string trim $message] $place"
    }
  }

  # --- the interface ---

  proc check_interface {interface} {
    if {[llength [getNodeTags]] == 0 || [llength [getEleTags]] == 0} {
      error "the script leaves no model: no nodes or no elements; is there a `wipe` at its end?"
    }
    foreach {node dof} $interface {
      if {$node ni [getNodeTags]} { error "the model has no node $node, which `interface` names" }
      set dofs [llength [nodeDisp $node]]
      if {$dof > $dofs} { error "node $node has $dofs degrees of freedom; `interface` names dof $dof" }
      if {![catch {getFixedDOFs $node} fixed] && $dof in $fixed} {
        error "the script fixes dof $dof of node $node, which is at the interface; leave it free"
      }
      if {![catch {getConstrainedDOFs $node} tied] && $dof in $tied} {
        error "dof $dof of node $node, at the interface, follows another node (equalDOF, rigidDiaphragm or rigidLink);\
          name the node that it follows"
      }
    }
  }

  # Each degree of freedom has a load pattern of its own with one constraint; its factor is the displacement. So no step
  # changes the model, and the equations keep their numbers.
  proc hold_interface {interface} {
    variable held {}
    variable origin {}
    variable tags {}
    loadConst -time 0.0
    set tag 900000000
    foreach {node dof} $interface {
      lappend origin [expr {double([nodeDisp $node $dof])}]
      lappend held $node $dof
      lappend tags [incr tag]
    }
    foreach {node dof} $interface tag $tags start $origin {
      pattern Plain $tag Constant "sp $node $dof 1.0"
      parameter $tag loadPattern $tag randomProcessDiscretizer factor
      updateParameter $tag $start
    }
  }

  proc impose {displacements} {
    variable tags
    foreach tag $tags displacement $displacements { updateParameter $tag $displacement }
  }

  # OpenSees does not pass the reactions of nodes that follow another one on to that node: they are summed here.
  # @return   for each degree of freedom of the interface a list of nodes and degrees of freedom
  proc find_sources {} {
    variable held
    variable has_ties
    set sources {}
    foreach {node dof} $held {
      set own [list $node $dof]
      if {$has_ties} {
        foreach follower [getConstrainedNodes $node] {
          set tied [getConstrainedDOFs $follower $node $dof]
          if {[llength $tied] == 0} { continue }
          set directions [llength [nodeCoord $node]]
          if {$dof > $directions && [nodeCoord $node] ne [nodeCoord $follower]} {
            error "node $follower follows the rotation of node $node, dof $dof at the interface, at a distance; put the\
              interface at a node that no other follows, joined to this one by an element"
          }
          lappend own $follower $dof
        }
      }
      lappend sources $own
    }
    return $sources
  }

  proc reactions_now {} {
    variable sources
    reactions
    set forces {}
    foreach own $sources {
      set force 0.0
      foreach {node dof} $own { set force [expr {$force + [nodeReaction $node $dof]}] }
      lappend forces $force
    }
    return $forces
  }

  # --- the analysis: the commands of the script where it has them ---

  proc chosen {command default} {
    variable user_command
    if {[info exists user_command($command)]} { return $user_command($command) }
    return $default
  }

  proc has_equations {} {
    variable held
    foreach node [getNodeTags] {
      set dofs [llength [nodeDisp $node]]
      set known {}
      catch { lappend known {*}[getFixedDOFs $node] }
      catch { lappend known {*}[getConstrainedDOFs $node] }
      foreach {held_node dof} $held { if {$held_node == $node} { lappend known $dof } }
      if {[llength [lsort -unique $known]] < $dofs} { return 1 }
    }
    return 0
  }

  proc set_up_analysis {tolerance} {
    variable algorithms
    variable test
    variable iterations_max
    variable user_command
    set commands [array get user_command]
    wipeAnalysis
    array set user_command $commands
    set handler [chosen constraints "constraints Transformation"]
    # Plain cannot hold a displacement that is not zero.
    if {[string match -nocase Plain* [lindex $handler 1]]} { set handler "constraints Transformation" }
    set test [chosen test "test NormDispIncr $tolerance $iterations_max"]
    if {[lindex $test 1] ni {NormDispIncr NormUnbalance EnergyIncr}} {
      set test "test NormDispIncr $tolerance $iterations_max"
    }
    set first [chosen algorithm "algorithm Newton"]
    set algorithms [list $first "algorithm NewtonLineSearch" "algorithm KrylovNewton" "algorithm ModifiedNewton -initial"]
    eval $handler
    eval [chosen numberer "numberer RCM"]
    # Most solvers end the program where a model has no equation of its own, such as a spring between two nodes.
    if {![has_equations] || [catch {eval [chosen system "system UmfPack"]}]} { system UmfPack }
    eval $test
    eval $first
    integrator LoadControl 0.0
    analysis Static
  }

  proc last_norm {} {
    set last 0.0
    foreach norm [testNorms] { if {$norm != 0.0} { set last $norm } }
    return $last
  }

  proc use {algorithm} {
    variable current
    variable has_trial_record
    if {$algorithm eq $current} { return }
    eval $algorithm
    set current $algorithm
    set has_trial_record 0
  }

  # One analysis, with one algorithm after the other; one that fails leaves the model as it was.
  proc converge {displacements} {
    variable algorithms
    variable residual
    impose $displacements
    foreach algorithm $algorithms {
      use $algorithm
      set is_converged [expr {[solve 1] == 0}]
      set residual [last_norm]
      if {$is_converged} { break }
    }
    use [lindex $algorithms 0]
    return $is_converged
  }

  # From one set of displacements to another, in halves where the whole does not converge.
  proc advance {from to halvings} {
    variable parts
    if {[converge $to]} {
      incr parts
      return 1
    }
    if {$halvings == 0} { return 0 }
    set middle {}
    foreach a $from b $to { lappend middle [expr {0.5 * ($a + $b)}] }
    return [expr {[advance $from $middle [expr {$halvings - 1}]] && [advance $middle $to [expr {$halvings - 1}]]}]
  }

  # The forces at the last iteration of an analysis are in files that the algorithm writes.
  proc record_trials {} {
    variable sources
    variable trial_file
    variable has_trial_record
    if {$has_trial_record} { return }
    set place 0
    foreach {node dof} [concat {*}$sources] {
      algorithmRecorder Node -file $trial_file.[incr place] -precision 17 -closeOnWrite -node $node -dof $dof reaction
    }
    set has_trial_record 1
  }

  proc recorded_forces {} {
    variable sources
    variable trial_file
    set forces {}
    set place 0
    foreach own $sources {
      set force 0.0
      foreach {node dof} $own {
        set file [open $trial_file.[incr place]]
        set force [expr {$force + [lindex [read $file] end]}]
        close $file
      }
      lappend forces $force
    }
    return $forces
  }

  # An analysis whose convergence test cannot pass: OpenSees then returns to the last committed state by itself.
  proc iterate {iterations} {
    variable test
    variable trial_file
    variable residual
    foreach file [glob -nocomplain $trial_file.*] { close [open $file w] }
    test [lindex $test 1] -1.0 $iterations
    # Without this, each trial would write that it failed.
    logFile /dev/null -noEcho
    solve 1
    logFile /dev/null
    set residual [lindex [testNorms] [expr {$iterations - 1}]]
    return [expr {[string is double -strict $residual] && $residual <= [lindex $test 2]}]
  }

  # Of the last trial, and one more: where the next one begins.
  proc iterations_needed {iterations} {
    variable test
    set needed 2
    foreach norm [lrange [testNorms] 0 [expr {$iterations - 2}]] {
      if {$norm <= [lindex $test 2]} { break }
      incr needed
    }
    return $needed
  }

  # The forces at displacements that the model does not keep; empty where no algorithm converges.
  proc try_point {displacements} {
    variable algorithms
    variable test
    variable trial_iterations
    variable iterations_max
    impose $displacements
    set forces {}
    foreach algorithm $algorithms {
      use $algorithm
      record_trials
      set iterations $trial_iterations
      while {![set is_converged [iterate $iterations]] && $iterations < $iterations_max} {
        set iterations [expr {min(2 * $iterations, $iterations_max)}]
      }
      if {$is_converged} {
        set forces [recorded_forces]
        set trial_iterations [iterations_needed $iterations]
        break
      }
    }
    use [lindex $algorithms 0]
    eval $test
    return $forces
  }

  # --- the conversation ---

  proc reply {letter forces text} {
    variable replies
    variable test
    variable residual
    variable parts
    set tolerance [expr {[info exists test] ? double([lindex $test 2]) : 0.0}]
    set norm [expr {[info exists residual] && [string is double -strict $residual] ? double($residual) : 0.0}]
    set iterations 0
    if {[info exists test]} { set iterations [testIter] }
    set bytes [encoding convertto utf-8 $text]
    puts -nonewline $replies [binary format a1x3nd4d* $letter [string length $bytes]\
      [list $norm $tolerance $iterations [expr {double($parts)}]] $forces]
    puts -nonewline $replies $bytes
    flush $replies
  }

  proc difference {a b} {
    set result {}
    foreach x $a y $b { lappend result [expr {$x - $y}] }
    return $result
  }

  proc sum {a b} {
    set result {}
    foreach x $a y $b { lappend result [expr {$x + $y}] }
    return $result
  }

  proc answer {request displacements} {
    variable at
    variable origin
    variable origin_forces
    variable parts
    variable steps
    variable step_s
    variable residual
    variable halvings_max
    set parts 0
    set target [sum $origin $displacements]
    if {$request eq "t"} {
      set forces [try_point $target]
    } else {
      setTime [expr {$steps * $step_s}]
      incr steps
      set forces {}
      if {[advance $at $target $halvings_max]} {
        set at $target
        set forces [reactions_now]
      }
    }
    set zeros [lrepeat [llength $displacements] 0.0]
    if {[llength $forces] == 0} {
      reply n $zeros ""
    } else {
      reply f [difference $forces $origin_forces] ""
    }
  }

  proc serve {count} {
    variable requests
    set bytes [expr {8 * ($count + 1)}]
    while {[string length [set message [read $requests $bytes]]] == $bytes} {
      binary scan $message a1x7d* request displacements
      answer $request $displacements
    }
  }

  proc begin {script mode tolerance interface} {
    variable held
    variable origin
    variable origin_forces
    variable at
    variable algorithms
    variable current
    variable has_ties
    variable sources
    guard_commands $mode
    run_script $script
    check_interface $interface
    hold_interface $interface
    if {$has_ties && [info commands getConstrainedNodes] eq ""} {
      error "this OpenSees ([version]) does not tell which nodes follow others (getConstrainedNodes), and the script has\
        such nodes; use a newer version, 3.3 or later"
    }
    set sources [find_sources]
    set_up_analysis $tolerance
    set current [lindex $algorithms 0]
    if {![converge $origin]} {
      error "the model finds no equilibrium under the loads of the script with its interface held"
    }
    foreach {node dof} $held start $origin {
      if {abs([nodeDisp $node $dof] - $start) > 1e-9 * (1.0 + abs($start))} {
        error "this OpenSees ([version]) does not impose a displacement through the parameter of a load pattern"
      }
    }
    set origin_forces [reactions_now]
    set at $origin
  }

  proc main {arguments} {
    variable requests
    variable replies
    variable trial_file
    variable step_s
    lassign $arguments request_file reply_file script mode step_s tolerance trial_file
    set interface [lrange $arguments 7 end]
    set requests [open $request_file rb]
    set replies [open $reply_file wb]
    set count [expr {[llength $interface] / 2}]
    set zeros [lrepeat $count 0.0]
    if {[catch { begin $script $mode $tolerance $interface } message]} {
      reply x $zeros $message
      ::hybridtest::leave 1
    }
    reply r $zeros "[llength [getNodeTags]] nodes, [llength [getEleTags]] elements, [systemSize] equations; OpenSees\
      [version]"
    if {[catch { serve $count } message]} {
      reply x $zeros $message
      ::hybridtest::leave 1
    }
    ::hybridtest::leave 0
  }
}

::hybridtest::main $argv
