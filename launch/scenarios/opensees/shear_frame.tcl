# A two-storey shear frame under a ground motion, for an OpenSees that leads a hybrid test: the first storey is the
# element genericClient, which the scenario shear_frame.yaml stands for.
#   hybridtest run shear_frame.yaml
#   OpenSees shear_frame.tcl unsplit       the same frame with the first storey in OpenSees, as a reference
#   OpenSees shear_frame.tcl unsplit steel    and with a storey that yields
# Writes floors.txt (time, displacement of both floors [m]) into the folder of the run or, started by hand, into this one.
# SI units.

set unsplit [expr {[lindex $argv 0] eq "unsplit"}]
set yields [expr {[lindex $argv end] eq "steel"}]
set here [file dirname [file normalize [info script]]]
set results $here
if {[info exists ::env(HYBRIDTEST_RUN_DIRECTORY)]} { set results $::env(HYBRIDTEST_RUN_DIRECTORY) }

set step_s 0.001
set duration_s 31.0

model BasicBuilder -ndm 1 -ndf 1
node 0 0.0
node 1 0.0 -mass 20.0e3
node 2 0.0 -mass 20.0e3
fix 0 1

uniaxialMaterial Elastic 2 3.0e6
element zeroLength 2 1 2 -mat 2 -dir 1 -doRayleigh 1
if {$unsplit} {
  if {$yields} {
    uniaxialMaterial Steel01 1 40.0e3 4.0e6 0.05
  } else {
    uniaxialMaterial Elastic 1 4.0e6
  }
  element zeroLength 1 0 1 -mat 1 -dir 1 -doRayleigh 1
} else {
  element genericClient 1 -node 1 -dof 1 -server 8090 127.0.0.1 -doRayleigh
}

# 2 % of critical damping in both modes, with the initial stiffness.
set omegas {}
foreach eigenvalue [eigen -fullGenLapack 2] { lappend omegas [expr {sqrt($eigenvalue)}] }
lassign $omegas first second
set per_omega [expr {2.0 * 0.02 / ($first + $second)}]
rayleigh [expr {$per_omega * $first * $second}] 0.0 $per_omega 0.0

# A PEER AT2 file: three lines of text, one with NPTS and DT, then the values in g.
set file [open [file join $here .. ground_motions design_ec8_c.AT2]]
set lines [split [read $file] "\n"]
close $file
regexp {DT=\s*([0-9.]+)} [lindex $lines 3] all motion_step_s
timeSeries Path 1 -dt $motion_step_s -values [concat {*}[lrange $lines 4 end]] -factor 9.80665
pattern UniformExcitation 1 1 -accel 1

recorder Node -file [file join $results floors.txt] -precision 17 -time -node 1 2 -dof 1 disp

# The operator-splitting method predicts a displacement, asks for its force once, and corrects with the initial stiffness.
constraints Plain
numberer Plain
system FullGeneral
test NormUnbalance 1.0 1
algorithm Linear -initial
integrator AlphaOS 1.0
analysis Transient
set failed [analyze [expr {round($duration_s / $step_s)}] $step_s]
wipe
exit $failed
