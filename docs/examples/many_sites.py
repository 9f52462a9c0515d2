"""Writes a scenario of many sites: python3 many_sites.py SITES [SECONDS] > scenario.yaml

A shear frame with a site in every storey, each an actuator with a specimen, all simulated and ideal: the result is that of
the same frame without substructures. The first two seconds shake the ground; the wave takes its time up the frame.
"""
import sys

sites = int(sys.argv[1])
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 4.0
floors = [f"floor_{i}" for i in range(1, sites + 1)]

print(f"""schema: hybridtest/1
name: frame_of_{sites}_sites
time: {{mode: lockstep, step_s: 0.01, duration_s: {seconds}}}
excitation: {{sweep: {{amplitude_m_per_s2: 1.0, from_hz: 0.5, to_hz: 5.0, duration_s: 2.0}}}}
structure:
  degrees_of_freedom: [{", ".join(floors)}]
  mass_kg: {{{", ".join(f"{floor}: 20.0e3" for floor in floors)}}}
  damping: {{type: none}}
integrator: {{type: alpha_operator_splitting, alpha: 0.0}}
substructures:""")
below = ""
for i, floor in enumerate(floors, 1):
    # One control period in a step keeps the recordings small. A site waits for the farthest of the others.
    print(f"""  - id: storey_{i}
    kind: experimental
    interface: [{{dof: {floor}{below}}}]
    initial_stiffness_n_per_m: [[400.0e6]]
    control_rate_hz: 100
    rig:
      type: simulated
      transfer_system: {{type: ideal}}
      specimen: {{type: elastic, stiffness_n_per_m: 400.0e6}}
    limits: {{displacement_m: 0.1, velocity_m_per_s: 2.0, force_n: 50.0e6, command_age_s: 5.0}}""")
    below = f", relative_to: {floor}"
