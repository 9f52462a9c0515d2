# Force of one material of OpenSees along a path of displacements:
#   OpenSees laws.tcl LAW STEPS_PER_SAMPLE DIRECTORY
# writes DIRECTORY/law_LAW.csv. The path goes straight from turn to turn, each way in the same number of samples, so that
# every turn is a sample. SI units.

set samples_per_way 20
set wild_m {0.006 -0.004 0.018 -0.012 0.022 -0.020 0.022 -0.022 0.034 -0.010 0.030 -0.034 -0.020 -0.034 0.034 -0.060 \
  0.050 -0.030 0.065 -0.065 0.080 -0.080 0.040 0.0}
# Without reversals before the largest displacement, whose treatment Hysteretic leaves out.
set growing_m {0.006 -0.004 0.018 0.014 0.018 -0.018 0.030 -0.030 0.030 -0.030 0.050 0.042 0.055 -0.055 0.080 -0.080 0.0}
# Laws that have a path of their own.
set paths [dict create takeda $growing_m]

# Both sides alike: elastic stiffness, displacements from yielding to the cap, from the cap to none and at the end, yield
# force, highest and residual strength over it; the four capacities over the yield force; exponents; rates.
set side {0.04 0.15 1.0 40.0e3 1.2 0.2}
set deterioration {2.0 3.0 2.5 4.0 1.0 1.0 1.0 1.0 1.0 1.0}
set laws [dict create \
  peak_oriented [list IMKPeakOriented 4.0e6 {*}$side {*}$side {*}$deterioration] \
  pinching [list IMKPinching 4.0e6 {*}$side {*}$side {*}$deterioration 0.3 0.4] \
  takeda {Hysteretic 40.0e3 0.01 48.0e3 0.05 62.0e3 0.12 -40.0e3 -0.01 -48.0e3 -0.05 -62.0e3 -0.12 1.0 1.0 0.0 0.0 0.4} \
  self_centring {SelfCentering 4.0e6 0.2e6 40.0e3 0.7} \
  giuffre_menegotto_pinto {Steel02 40.0e3 4.0e6 0.03 18.0 0.925 0.15 0.05 1.5 0.03 2.5} \
  softening_bilinear {Steel01 40.0e3 4.0e6 -0.05} \
  softening_giuffre_menegotto_pinto {Steel02 40.0e3 4.0e6 -0.05 18.0 0.925 0.15}]

lassign $argv law steps_per_sample directory
model testUniaxial 1
set material [dict get $laws $law]
uniaxialMaterial [lindex $material 0] 1 {*}[lrange $material 1 end]
uniaxialTest 1

set output [open [file join $directory law_$law.csv] w]
puts $output "displacement_m,force_n"
set turns_m [expr {[dict exists $paths $law] ? [dict get $paths $law] : $wild_m}]
set from_m 0.0
set steps_per_way [expr {$samples_per_way * $steps_per_sample}]
foreach turn_m $turns_m {
  for {set step 1} {$step <= $steps_per_way} {incr step} {
    set displacement_m [expr {$from_m + ($turn_m - $from_m) * $step / $steps_per_way}]
    strainUniaxialTest $displacement_m
    if {$step % $steps_per_sample == 0} { puts $output [format "%.9f,%.4f" $displacement_m [stressUniaxialTest]] }
  }
  set from_m $turn_m
}
close $output
