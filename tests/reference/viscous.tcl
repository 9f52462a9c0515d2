# Force of the material Viscous of OpenSees, whose end is moved in a sine:
#   OpenSees viscous.tcl DIRECTORY
# writes DIRECTORY/law_viscous.csv. SI units.

lassign $argv directory
set damping_n_s_per_m 2.0e5
set exponent 0.5
set amplitude_m 0.05
set period_s 2.0
set duration_s 3.0
set step_s 0.0125

model BasicBuilder -ndm 1 -ndf 1
node 1 0.0
node 2 0.0 -mass 1.0
fix 1 1
uniaxialMaterial Viscous 1 $damping_n_s_per_m $exponent
element zeroLength 1 1 2 -mat 1 -dir 1
# Without a degree of freedom that is free there is no analysis.
node 3 0.0 -mass 1.0
uniaxialMaterial Elastic 2 1.0
element zeroLength 2 1 3 -mat 2 -dir 1

set rate_rad_per_s [expr {2.0 * acos(-1.0) / $period_s}]
timeSeries Trig 1 0.0 $duration_s $period_s -factor $amplitude_m
timeSeries Trig 2 0.0 $duration_s $period_s -factor [expr {$amplitude_m * $rate_rad_per_s}] -shift [expr {acos(0.0)}]
pattern MultipleSupport 1 {
  groundMotion 1 Plain -disp 1 -vel 2
  imposedMotion 2 1 1
}
constraints Transformation
numberer Plain
system FullGeneral
test NormDispIncr 1.0e-12 50
algorithm Newton
integrator Newmark 0.5 0.25
analysis Transient

set output [open [file join $directory law_viscous.csv] w]
puts $output "displacement_m,velocity_m_per_s,force_n"
set samples [expr {round($duration_s / $step_s) - 1}]
for {set sample 1} {$sample <= $samples} {incr sample} {
  if {[analyze 1 $step_s] != 0} { error "no equilibrium before [getTime] s" }
  puts $output [format "%.9f,%.15e,%.4f" [nodeDisp 2 1] [nodeVel 2 1] [lindex [eleResponse 1 material 1 stress] 0]]
}
close $output
