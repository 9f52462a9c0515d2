# A space frame of three storeys and one by two bays: elastic beam-columns, masses at the nodes along x and y alone, no
# rigid floors. Writes what its structure section reads (mass.mtx, stiffness.mtx, dofs.csv) and the motion under a
# ground acceleration along x and y at once (x.txt, y.txt, history.csv).
#   OpenSees frame_3d.tcl STEP OUT
lassign $argv step out
model BasicBuilder -ndm 3 -ndf 6
set storeys 3
set height 3.2
set bay_x 6.0
set bay_y 5.0
proc tag {storey i j} { return [expr 100 * $storey + 10 * $i + $j] }
for {set s 0} {$s <= $storeys} {incr s} {
  for {set i 0} {$i <= 2} {incr i} {
    for {set j 0} {$j <= 1} {incr j} {
      node [tag $s $i $j] [expr $bay_x * $i] [expr $bay_y * $j] [expr $height * $s]
      if {$s == 0} { fix [tag 0 $i $j] 1 1 1 1 1 1 }
      # The mass is uneven, so that the frame twists.
      if {$s > 0} { mass [tag $s $i $j] [expr 8.0e3 + 2.0e3 * $i] [expr 8.0e3 + 2.0e3 * $i] 0 0 0 0 }
    }
  }
}
geomTransf Linear 1 1 0 0
geomTransf Linear 2 0 0 1
set E 30.0e9
set G 12.5e9
set element 0
for {set s 1} {$s <= $storeys} {incr s} {
  for {set i 0} {$i <= 2} {incr i} {
    for {set j 0} {$j <= 1} {incr j} {
      element elasticBeamColumn [incr element] [tag [expr $s - 1] $i $j] [tag $s $i $j] 0.16 $E $G 3.6e-3 2.1333e-3 2.1333e-3 1
    }
  }
  for {set j 0} {$j <= 1} {incr j} {
    for {set i 0} {$i <= 1} {incr i} {
      element elasticBeamColumn [incr element] [tag $s $i $j] [tag $s [expr $i + 1] $j] 0.15 $E $G 2.8e-3 1.1e-3 3.1e-3 2
    }
  }
  for {set i 0} {$i <= 2} {incr i} {
    element elasticBeamColumn [incr element] [tag $s $i 0] [tag $s $i 1] 0.15 $E $G 2.8e-3 1.1e-3 3.1e-3 2
  }
}
# In coordinates, the lower triangle, with the digits that the program gives.
proc write_matrix {name} {
  global out
  set entries [printA -ret]
  set size [expr int(sqrt([llength $entries]))]
  set lines {}
  for {set row 0} {$row < $size} {incr row} {
    for {set column 0} {$column <= $row} {incr column} {
      set entry [lindex $entries [expr $row * $size + $column]]
      if {$entry != 0} { lappend lines "[expr $row + 1] [expr $column + 1] $entry" }
    }
  }
  set file [open $out/$name.mtx w]
  puts $file "%%MatrixMarket matrix coordinate real symmetric"
  puts $file "$size $size [llength $lines]"
  puts $file [join $lines "\n"]
  close $file
}
proc set_up {} {
  constraints Plain
  numberer Plain
  system FullGeneral
  test NormDispIncr 1e-10 10
  algorithm Linear
}
foreach {name m k} {mass 1.0 0.0 stiffness 0.0 1.0} {
  set_up
  integrator GimmeMCK $m 0.0 $k
  analysis Transient
  analyze 1 0.0
  write_matrix $name
  if {$name eq "stiffness"} {
    set rows {}
    for {set s 1} {$s <= $storeys} {incr s} {
      for {set i 0} {$i <= 2} {incr i} {
        for {set j 0} {$j <= 1} {incr j} {
          foreach number [nodeDOFs [tag $s $i $j]] direction {x y z rx ry rz} {
            lappend rows [list $number [tag $s $i $j] $direction]
          }
        }
      }
    }
    set file [open $out/dofs.csv w]
    puts $file "node,direction"
    foreach row [lsort -integer -index 0 $rows] { puts $file "[lindex $row 1],[lindex $row 2]" }
    close $file
  }
  wipeAnalysis
}
set_up
set file [open $out/eigenvalues.csv w]
puts $file [join [eigen -fullGenLapack 6] ","]
close $file
rayleigh 0.35 0.0 0.0006 0.0
# Three frequencies in each direction, with a build-up and a decay.
foreach {name phase} {x 0.0 y 1.1} {
  set file [open $out/$name.txt w]
  for {set i 0} {$i <= 1000} {incr i} {
    set t [expr 0.01 * $i]
    set size [expr min(1.0, $t / 2) * max(0.0, min(1.0, (9 - $t) / 3))]
    set turn [expr 6.283185307179586 * $t]
    puts $file [format %.6f [expr $size * (1.8 * sin(2.1 * $turn + $phase) + 1.2 * sin(3.7 * $turn + 2 * $phase) + \
                                           0.8 * sin(0.9 * $turn))]]
  }
  close $file
}
timeSeries Path 1 -dt 0.01 -filePath $out/x.txt -factor 1.0
timeSeries Path 2 -dt 0.01 -filePath $out/y.txt -factor 1.0
pattern UniformExcitation 1 1 -accel 1
pattern UniformExcitation 2 2 -accel 2
wipeAnalysis
constraints Plain
numberer RCM
system ProfileSPD
test NormDispIncr 1e-10 10
algorithm Linear -factorOnce
integrator Newmark 0.5 0.25
analysis Transient
set file [open $out/history.csv w]
puts $file "time_s,300.x_m,300.y_m,321.x_m,321.y_m"
set each [expr round(0.05 / $step)]
for {set i 1} {$i <= 200} {incr i} {
  if {[analyze $each $step] != 0} { error "the analysis failed" }
  puts $file [format %.2f,%.9e,%.9e,%.9e,%.9e [expr 0.05 * $i] [nodeDisp 300 1] [nodeDisp 300 2] [nodeDisp 321 1] \
                  [nodeDisp 321 2]]
}
close $file
