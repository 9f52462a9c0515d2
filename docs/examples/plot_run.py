"""Plots one table of a run: python3 plot_run.py RUN_FILE.h5 TABLE FIGURE.png (or .svg, .pdf).

Names, units, sample rate and time come from the file. Needs h5py and matplotlib (Debian: python3-h5py, python3-matplotlib).
"""
import sys

import h5py
import matplotlib

matplotlib.use("Agg")  # no screen needed
import matplotlib.pyplot as plt

file_name, table_name, figure_name = sys.argv[1:]
with h5py.File(file_name, "r") as run:  # while the test runs: h5py.File(file_name, "r", swmr=True)
    table = run[table_name]
    names = [name.decode() for name in table.attrs["column_names"]]
    units = dict(zip(names, (unit.decode() for unit in table.attrs["units"])))
    time = table.attrs["time_column"].decode()
    rows = table[:]
    print(f"{table_name}: {table.attrs['description'].decode()}")
    print(f"{len(rows)} rows at {table.attrs['sample_rate_hz']:g} Hz; t0 {run.attrs['t0_utc'].decode()}")
    groups = [unit for unit in dict.fromkeys(units.values()) if unit not in ("", units[time])]
    figure, axes = plt.subplots(len(groups), sharex=True, squeeze=False, figsize=(10, 3 * len(groups)))
    for axis, unit in zip(axes[:, 0], groups):
        for name in (name for name in names if units[name] == unit):
            axis.plot(rows[time], rows[name], label=name, linewidth=0.8)
            print(f"{name} [{unit}]: {rows[name].min():.9g} to {rows[name].max():.9g}")
        axis.set_ylabel(unit)
        axis.legend(fontsize="small")
    axes[-1, 0].set_xlabel(f"{time} [{units[time]}]")
    figure.savefig(figure_name)
