function plot_results(file, point)
% Frequency over energy with its events (Fig. 3 b of Peter et al. 2019), and the contact forces of one period.
%
%   plot_results('results/rod/results.mat')        the last point with a history
%   plot_results('results/rod/results.mat', 12)    point 12, if `output.histories` asked for it
%
% The file comes from a run with `[output] matlab = true`. Runs in MATLAB and in Octave.
results = load(file);
branch = results.branch;

figure(1); clf; hold on;
semilogx(branch.energy_j, branch.frequency_hz, '-', 'linewidth', 1.5);
happened = find(~cellfun('isempty', branch.event));
semilogx(branch.energy_j(happened), branch.frequency_hz(happened), 'o');
set(gca, 'xscale', 'log');
xlabel('averaged kinetic energy in J'); ylabel('frequency in Hz'); grid on;

histories = results.histories;
if isempty(histories.point), return; end
row = numel(histories.point);
if nargin > 1
  row = find(histories.point == point);
  if isempty(row), error('point %d has no history: it is not in output.histories', point); end
end
figure(2); clf;
force = reshape(histories.force_n(row, :, :), size(histories.force_n, 2), size(histories.force_n, 3));
plot(1e3 * histories.time_s(row, :), force, 'linewidth', 1.5);
xlabel('time in ms'); ylabel('contact force in N'); grid on;
title(sprintf('point %d, %.4f Hz', histories.point(row), branch.frequency_hz(histories.point(row) + 1)));
end
