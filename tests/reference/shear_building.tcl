# Reference histories of the buildings of launch/scenarios under the shipped design motion, computed by OpenSees:
#   OpenSees shear_building.tcl BUILDING STEP_S DIRECTORY
# writes DIRECTORY/BUILDING.csv. A building is a chain of masses and storeys, with the ground below the first storey.
# SI units. Newmark's average acceleration; each step is iterated to equilibrium.

set here [file dirname [file normalize [info script]]]
set motion_file [file join $here .. .. launch scenarios ground_motions design_ec8_c.AT2]
set standard_gravity_m_per_s2 9.80665
set duration_s 31.0
set sample_s 0.01

# Per building: masses [kg], materials of the storeys from below, the two modes with 2 % of critical damping; where it has
# one, the material of a damper beside the first storey.
set ratio 0.02
set two_masses_kg {20.0e3 20.0e3}
set upper_storey {Elastic 3.0e6}
set buildings [dict create \
  two_storey_linear [list $two_masses_kg [list {Elastic 4.0e6} $upper_storey] {1 2}] \
  two_storey_bilinear [list $two_masses_kg [list {Steel01 40.0e3 4.0e6 0.05} $upper_storey] {1 2}] \
  two_storey_steel02 [list $two_masses_kg [list {Steel02 40.0e3 4.0e6 0.03 18.0 0.925 0.15} $upper_storey] {1 2}] \
  two_storey_boucwen [list $two_masses_kg [list {BoucWen 0.1 4.0e6 1.0 50.0 50.0 1.0 0.0 0.0 0.0 1.0e-14 100} \
    $upper_storey] {1 2}] \
  three_storey_base_isolated [list {20.0e3 15.0e3 15.0e3 15.0e3} \
    [list {BoucWen 0.1 6.4e6 1.0 90.0 90.0 1.0 0.0 0.0 0.0 1.0e-14 100} {Elastic 2.0e7} {Elastic 2.0e7} \
      {Elastic 2.0e7}] {2 3}] \
  isolated_with_dampers [list {20.0e3 15.0e3 15.0e3 15.0e3} \
    [list [list Steel01 [expr {4.44e6 * 0.01}] 4.44e6 [expr {0.64e6 / 4.44e6}]] {Elastic 2.0e7} {Elastic 2.0e7} \
      {Elastic 2.0e7}] {2 3} {Viscous 40.0e3 0.5}]]

lassign $argv building step_s directory
lassign [dict get $buildings $building] masses_kg materials modes damper

# A PEER AT2 file: three lines of text, one with NPTS and DT, then the values in g.
proc read_at2 {path} {
  set file [open $path]
  set lines [split [read $file] "\n"]
  close $file
  if {![regexp {NPTS=\s*(\d+),\s*DT=\s*([0-9.]+)} [lindex $lines 3] all count step_s]} { error "no AT2 header" }
  set values [concat {*}[lrange $lines 4 end]]
  if {[llength $values] != $count} { error "$count values expected, [llength $values] found" }
  return [list $step_s $values]
}

model BasicBuilder -ndm 1 -ndf 1
node 0 0.0
fix 0 1
set floor 0
foreach mass_kg $masses_kg material $materials {
  incr floor
  node $floor 0.0 -mass $mass_kg
  uniaxialMaterial [lindex $material 0] $floor {*}[lrange $material 1 end]
  element zeroLength $floor [expr {$floor - 1}] $floor -mat $floor -dir 1 -doRayleigh 1
}
set floors $floor
if {$damper ne ""} {
  set tag [expr {$floors + 1}]
  uniaxialMaterial [lindex $damper 0] $tag {*}[lrange $damper 1 end]
  element zeroLength $tag 0 1 -mat $tag -dir 1 -doRayleigh 0
}

# Rayleigh damping of mass and initial stiffness from the frequencies of this very model.
set frequencies {}
foreach eigenvalue [eigen -fullGenLapack $floors] { lappend frequencies [expr {sqrt($eigenvalue)}] }
lassign $modes lower upper
set lower_rad_per_s [lindex $frequencies [expr {$lower - 1}]]
set upper_rad_per_s [lindex $frequencies [expr {$upper - 1}]]
set mass_per_s [expr {2.0 * $ratio * $lower_rad_per_s * $upper_rad_per_s / ($lower_rad_per_s + $upper_rad_per_s)}]
set stiffness_s [expr {2.0 * $ratio / ($lower_rad_per_s + $upper_rad_per_s)}]
rayleigh $mass_per_s 0.0 $stiffness_s 0.0
puts "$building: frequencies [lmap f $frequencies {format %.6f $f}] rad/s, mass_per_s $mass_per_s, stiffness_s $stiffness_s"

lassign [read_at2 $motion_file] motion_step_s accelerations_g
timeSeries Path 1 -dt $motion_step_s -values $accelerations_g -factor $standard_gravity_m_per_s2
pattern UniformExcitation 1 1 -accel 1

constraints Plain
numberer Plain
system FullGeneral
test NormDispIncr 1.0e-14 100
algorithm Newton
integrator Newmark 0.5 0.25
analysis Transient

set steps_per_sample [expr {round($sample_s / $step_s)}]
set samples [expr {round($duration_s / $sample_s)}]
set output [open [file join $directory $building.csv] w]
set names time_s
for {set floor 1} {$floor <= $floors} {incr floor} { append names ",displacement_${floor}_m" }
puts $output "$names,storey_force_1_n"
for {set sample 1} {$sample <= $samples} {incr sample} {
  if {[analyze $steps_per_sample $step_s] != 0} { error "no equilibrium before [getTime] s" }
  set row [format %.2f [getTime]]
  for {set floor 1} {$floor <= $floors} {incr floor} { append row [format ,%.9f [nodeDisp $floor 1]] }
  append row [format ,%.2f [lindex [eleResponse 1 material 1 stress] 0]]
  # Rounding leaves signs on zeros.
  puts $output [regsub -all {,-(0\.0+)(?=,|$)} $row {,\1}]
}
close $output
