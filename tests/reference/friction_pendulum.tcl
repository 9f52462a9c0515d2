# Force of a friction pendulum of OpenSees that is moved in a sine:
#   OpenSees friction_pendulum.tcl DIRECTORY
# writes DIRECTORY/law_friction_pendulum.csv. SI units. The dish is flat for its travel, because SingleFPSimple2d tilts
# friction and weight with the dish and the law does not: that differs by friction coefficient times slope, here 2e-4.

lassign $argv directory
set weight_n 4.0e5
set radius_m 20.0
set presliding_m 0.001
set slow 0.04
set fast 0.08
set rate_s_per_m 50.0
set amplitude_m 0.05
set period_s 2.0
set duration_s 3.0
set step_s 0.0001
set steps_per_sample 125

model BasicBuilder -ndm 2 -ndf 3
node 1 0.0 0.0
node 2 0.0 0.0 -mass 1.0 1.0 1.0
fix 1 1 1 1
fix 2 0 0 1
frictionModel VelDependent 1 $slow $fast $rate_s_per_m
uniaxialMaterial Elastic 1 1.0e10
element singleFPBearing 1 1 2 1 $radius_m [expr {$fast * $weight_n / $presliding_m + $weight_n / $radius_m}] -P 1 -Mz 1 \
  -orient 0 1 0 -1 0 0 -iter 100 1.0e-6

proc solve_by {args} {
  constraints Transformation
  numberer Plain
  system FullGeneral
  test NormDispIncr 1.0e-12 50
  algorithm Newton
  integrator {*}$args
}
timeSeries Constant 1
pattern Plain 1 1 { load 2 0.0 -$weight_n 0.0 }
solve_by LoadControl 1.0
analysis Static
if {[analyze 1] != 0} { error "no equilibrium under the weight" }
loadConst -time 0.0
wipeAnalysis

set rate_rad_per_s [expr {2.0 * acos(-1.0) / $period_s}]
timeSeries Trig 2 0.0 $duration_s $period_s -factor $amplitude_m
timeSeries Trig 3 0.0 $duration_s $period_s -factor [expr {$amplitude_m * $rate_rad_per_s}] -shift [expr {acos(0.0)}]
pattern MultipleSupport 2 {
  groundMotion 1 Plain -disp 2 -vel 3
  imposedMotion 2 1 1
}
solve_by Newmark 0.5 0.25
analysis Transient

set output [open [file join $directory law_friction_pendulum.csv] w]
puts $output "displacement_m,velocity_m_per_s,force_n"
set samples [expr {round($duration_s / $step_s / $steps_per_sample) - 1}]
for {set sample 1} {$sample <= $samples} {incr sample} {
  if {[analyze $steps_per_sample $step_s] != 0} { error "no equilibrium before [getTime] s" }
  puts $output [format "%.9f,%.9f,%.4f" [nodeDisp 2 1] [nodeVel 2 1] [lindex [eleResponse 1 force] 3]]
}
close $output
