function plot_results(file, point)
% Frequency over energy as in Fig. 3 b of Peter et al. 2019 and in the figure of the run, and the contact forces of one period.
%
%   plot_results('results/rod/results.mat')        the last point with a history
%   plot_results('results/rod/results.mat', 12)    point 12, if `output.histories` asked for it
%
% The file comes from a run with `[output] matlab = true`. Runs in MATLAB and in Octave.
results = load(file);
branch = results.branch;
[energy, frequency] = deal(branch.energy_j(:), branch.frequency_hz(:));
n = numel(energy);
events = cellfun(@(names) strsplit(names, ' '), branch.event(:), 'UniformOutput', false);
has = @(name) find(cellfun(@(names) any(strcmp(names, name)), events));

figure(1); clf; hold on;
blue = [0, 0.447, 0.698];
resumed = has('resumed');
firsts = unique([1; resumed(resumed > 1)]);
lasts = [firsts(2:end) - 1; n];
corners = [has('kink'); has('contact-change'); has('branch-point')];
for k = 1:numel(firsts)
  own = (firsts(k):lasts(k))';
  curve = smooth(energy(own), frequency(own), corners - firsts(k) + 1);
  shown = semilogx(curve(:, 1), curve(:, 2), '-', 'color', blue, 'linewidth', 1.5);
end
entries = shown; names = {'branch'};
range = log([min(energy), max(energy)]);
ends = exp(range + diff(range) * [-0.15, 0.05]);
grazing = intersect(has('grazing'), [1; n]);
if ~isempty(grazing)
  at = grazing(1);
  entries(end + 1) = semilogx([ends(1), energy(at)], frequency([at, at]), '--', 'color', blue, 'linewidth', 1.5);
  names{end + 1} = 'linear mode';
end
markers = 'o^sdvp*xh<>+';
happened = unique([events{:}], 'stable');
happened = happened(~cellfun('isempty', happened));
for k = 1:numel(happened)
  at = has(happened{k});
  entries(end + 1) = semilogx(energy(at), frequency(at), markers(mod(k - 1, numel(markers)) + 1), 'linewidth', 1.2);
  names{end + 1} = strrep(happened{k}, '-', ' ');
end
set(gca, 'xscale', 'log', 'xlim', ends);
if ends(2) / ends(1) < 30
  % Less than two decades: numbers in between.
  steps = [1, 2, 5, 10] * 10 ^ floor(log10(diff(ends) / 5));
  step = steps(find(steps >= diff(ends) / 6, 1));
  set(gca, 'xtick', ceil(ends(1) / step) * step:step:ends(2), 'xticklabelmode', 'auto');
end
xlabel('averaged kinetic energy in J'); ylabel('frequency in Hz'); grid on; box on;
legend(entries, names, 'location', 'northeastoutside');

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
legend(arrayfun(@(stop) sprintf('stop %d', stop), 0:size(force, 1) - 1, 'UniformOutput', false));
title(sprintf('point %d, %.4f Hz', histories.point(row), branch.frequency_hz(histories.point(row) + 1)));
end

function curve = smooth(x, y, corners)
% The curve through the points, smooth but where it may turn, over its length in the figure.
n = numel(x);
if n < 3, curve = [x, y]; return; end
u = log(x);
height = max(max(y) - min(y), eps(max(abs(y))));
len = [0; cumsum(max(hypot(diff(u) / (max(u) - min(u)), diff(y) / height), 1e-12))];
ends = unique([1; corners(corners > 1 & corners < n); n]);
curve = zeros(0, 2);
for k = 1:numel(ends) - 1
  own = (ends(k):ends(k + 1))';
  fine = unique([linspace(len(own(1)), len(own(end)), 20 * (numel(own) - 1) + 1)'; len(own)]);
  curve = [curve; exp(interp1(len(own), u(own), fine, 'pchip')), interp1(len(own), y(own), fine, 'pchip')];
end
end
