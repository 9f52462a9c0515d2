# A two-storey frame on isolators, for a hybrid test in which OpenSees computes the frame and a laboratory tests the
# isolators: isolated_frame.yaml uses it as the model of a substructure.
#   hybridtest run isolated_frame.yaml
#   OpenSees isolated_frame.tcl unsplit          everything in OpenSees, with elastic isolators, as a reference
#   OpenSees isolated_frame.tcl unsplit steel    and with isolators that yield
# The reference writes levels.txt (time, displacement of the three levels [m]). SI units.

set unsplit [expr {[lindex $argv 0] eq "unsplit"}]
set yields [expr {[lindex $argv end] eq "steel"}]

model BasicBuilder -ndm 2 -ndf 3
foreach {left right height} {1 2 0.0  3 4 3.0  5 6 6.0} {
  node $left 0.0 $height
  node $right 6.0 $height
  equalDOF $left $right 1
}
# The raft on the isolators moves across alone.
fix 1 0 1 1
fix 2 0 1 1

geomTransf Linear 1
set modulus 200.0e9
foreach {column bottom top} {1 1 3  2 2 4  3 3 5  4 4 6} {
  element elasticBeamColumn $column $bottom $top 0.015 $modulus 2.0e-4 1
}
foreach {beam left right} {5 3 4  6 5 6} {
  element elasticBeamColumn $beam $left $right 0.010 $modulus 3.0e-4 1
}
if {!$unsplit} { return }

# From here on what the test has outside the frame: masses, isolators, ground motion, integration.
mass 1 60.0e3 0.0 0.0
mass 3 40.0e3 0.0 0.0
mass 5 40.0e3 0.0 0.0
node 10 0.0 0.0
fix 10 1 1 1
if {$yields} {
  uniaxialMaterial Steel01 10 70.0e3 8.0e6 0.1
} else {
  uniaxialMaterial Elastic 10 8.0e6
}
element zeroLength 10 10 1 -mat 10 -dir 1 -doRayleigh 1
rayleigh 0.05 0.0 1.0e-3 0.0

# A PEER AT2 file: four lines of text, the last with NPTS and DT, then the values in g.
set file [open [file join [file dirname [file normalize [info script]]] .. ground_motions design_ec8_c.AT2]]
set lines [split [read $file] "\n"]
close $file
regexp {DT=\s*([0-9.]+)} [lindex $lines 3] all motion_step_s
timeSeries Path 1 -dt $motion_step_s -values [concat {*}[lrange $lines 4 end]] -factor 9.80665
pattern UniformExcitation 1 1 -accel 1
recorder Node -file levels.txt -precision 17 -time -node 1 3 5 -dof 1 disp

constraints Transformation
numberer RCM
system BandGeneral
test NormDispIncr 1.0e-12 20
algorithm Newton
integrator Newmark 0.5 0.25
analysis Transient
set failed [analyze 31000 0.001]
wipe
exit $failed
