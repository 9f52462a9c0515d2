% Plots the control loop of a site. Names, units, sample rate and time come from the file.
% MATLAB R2016b or newer; older releases do not read the HDF5 1.10 format.
file = 'storey_1.h5';
control = h5read(file, '/control');
names = cellstr(h5readatt(file, '/control', 'column_names'));
units = cellstr(h5readatt(file, '/control', 'units'));
time = char(h5readatt(file, '/control', 'time_column'));
rate_hz = h5readatt(file, '/control', 'sample_rate_hz');
t0_utc = char(h5readatt(file, '/', 't0_utc'));
fprintf('%d rows at %g Hz; t0 %s\n', numel(control.time_s), rate_hz, t0_utc);

subplot(2, 1, 1);
plot(control.(time), [control.target_displacement_m, control.measured_displacement_m]);
legend('target', 'measured');
ylabel(['displacement [' units{strcmp(names, 'measured_displacement_m')} ']']);
xlabel([time ' [' units{strcmp(names, time)} ']']);
subplot(2, 1, 2);
plot(control.measured_displacement_m, control.measured_force_n);
xlabel(['displacement [' units{strcmp(names, 'measured_displacement_m')} ']']);
ylabel(['force [' units{strcmp(names, 'measured_force_n')} ']']);
