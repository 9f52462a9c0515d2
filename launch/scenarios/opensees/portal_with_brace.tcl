# A steel portal of three bays with fibre beam-columns, braced in its middle bay, for an OpenSees that leads a hybrid test:
# the brace is the element genericClient, which the scenario portal_with_brace.yaml stands for.
#   hybridtest run portal_with_brace.yaml
#   OpenSees portal_with_brace.tcl unsplit     the same portal with the brace in OpenSees, as a reference
# Writes roof.txt (time, displacement of the roof [m]) into the folder of the run or, started by hand, into this one.
# SI units.

set unsplit [expr {[lindex $argv 0] eq "unsplit"}]
set here [file dirname [file normalize [info script]]]
set results $here
if {[info exists ::env(HYBRIDTEST_RUN_DIRECTORY)]} { set results $::env(HYBRIDTEST_RUN_DIRECTORY) }

set step_s 0.002
set duration_s 31.0
set height_m 4.0
set bay_m 6.0
set mass_kg 15.0e3
set gravity_m_per_s2 9.80665

# Columns 1 to 4 from the left: base i, roof 10 + i.
model BasicBuilder -ndm 2 -ndf 3
foreach column {1 2 3 4} {
  set x_m [expr {($column - 1) * $bay_m}]
  node $column $x_m 0.0
  node 1$column $x_m $height_m -mass $mass_kg $mass_kg 1.0
  fix $column 1 1 1
}

# A welded I section, 350 mm deep: flanges 250 x 15 mm, web 10 mm.
uniaxialMaterial Steel02 1 250.0e6 200.0e9 0.01 18.0 0.925 0.15
section Fiber 1 {
  patch rect 1 2 8 0.160 -0.125 0.175 0.125
  patch rect 1 8 1 -0.160 -0.005 0.160 0.005
  patch rect 1 2 8 -0.175 -0.125 -0.160 0.125
}
geomTransf Linear 1
foreach column {1 2 3 4} { element forceBeamColumn $column $column 1$column 5 1 1 }
foreach beam {1 2 3} { element forceBeamColumn 1$beam 1$beam 1[expr {$beam + 1}] 5 1 1 }

# Weight, before the brace is there: it carries none.
timeSeries Linear 1
pattern Plain 1 1 {
  foreach column {1 2 3 4} { load 1$column 0.0 [expr {-$mass_kg * $gravity_m_per_s2}] 0.0 }
}
constraints Plain
numberer RCM
system BandGeneral
test NormDispIncr 1.0e-10 20
algorithm Newton
integrator LoadControl 0.1
analysis Static
if {[analyze 10] != 0} { exit 1 }
loadConst -time 0.0
wipeAnalysis

# The brace holds the second column's roof in the horizontal direction.
if {$unsplit} {
  node 5 $bay_m $height_m
  fix 5 1 1 1
  uniaxialMaterial Steel02 5 100.0e3 20.0e6 0.03 18.0 0.925 0.15
  element zeroLength 5 5 12 -mat 5 -dir 1 -doRayleigh 1
} else {
  element genericClient 5 -node 12 -dof 1 -server 8090 127.0.0.1 -doRayleigh
}

# 2 % of critical damping in the sway mode and at 20 Hz, with the initial stiffness.
set pi [expr {acos(-1.0)}]
set sway [expr {sqrt([lindex [eigen 1] 0])}]
set high [expr {2.0 * $pi * 20.0}]
set per_omega [expr {2.0 * 0.02 / ($sway + $high)}]
rayleigh [expr {$per_omega * $sway * $high}] 0.0 $per_omega 0.0

# A PEER AT2 file: three lines of text, one with NPTS and DT, then the values in g.
set file [open [file join $here .. ground_motions design_ec8_c.AT2]]
set lines [split [read $file] "\n"]
close $file
regexp {DT=\s*([0-9.]+)} [lindex $lines 3] all motion_step_s
timeSeries Path 2 -dt $motion_step_s -values [concat {*}[lrange $lines 4 end]] -factor $gravity_m_per_s2
pattern UniformExcitation 2 1 -accel 2

recorder Node -file [file join $results roof.txt] -precision 17 -time -node 12 -dof 1 disp

# The operator-splitting method predicts a displacement, asks for its force once, and corrects with the initial stiffness.
constraints Plain
numberer RCM
system BandGeneral
test NormUnbalance 1.0 1
algorithm Linear -initial
integrator AlphaOS 0.9
analysis Transient
set failed [analyze [expr {round($duration_s / $step_s)}] $step_s]
wipe
exit $failed
