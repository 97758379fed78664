function handles = plot(result, varargin)
%NLMODES.PLOT  Results in the current axes.
%
%   nlmodes.plot(result)
%   nlmodes.plot(result, 'frequency_hz', 'peak_contact_force_n')      any two columns
%   nlmodes.plot(computed, 'over', test)                              measured points over computed curves
%   nlmodes.plot(computed, 'energy_j', 'frequency_hz', 'over', test)
%   handles = nlmodes.plot(...)                                       one for each curve
%
% Drawn are, if not said otherwise,
%   of modes           frequency over energy, columns of branch.csv
%   of responses       the amplitude of the drive point over frequency
%   of tests           frequency over modal amplitude, columns of modal_points.csv, with bars of their standard errors
%   with 'over'        frequency over modal amplitude; of responses modal amplitude over frequency
%   of motions in time displacements over time_s; others are arrays of transient.npz, as 'velocity_m_s', 'force_n', or
%                      'spectrum_m' over 'spectrum_frequency_hz'
%
% What is laid over is a result of nlmodes.extract, nlmodes.run or nlmodes.read, a structure with columns of these
% names, or a cell array of them. Curves are solid where motions are stable, dashed where they are unstable, and thin
% and pale where this is not known though it is for others of the same curve. There is a gap where an internal resonance
% has been left out. Each kind of event (grazing, folds, kinks, branch points, ...) has a marker.
[names, over] = arguments_of(varargin);
curves = curves_of(result, names);
if isempty(curves)
  error('nlmodes:run', '%s holds no branch', result.folder);
end
of_test = cell(1, numel(over));
for k = 1:numel(over), of_test{k} = laid_over(over{k}); end
curves = [curves, of_test{:}];
if isempty(names), names = defaults_of(curves, ~isempty(over)); end
[x, y] = names{:};
for k = 1:numel(curves), expect_columns(curves(k).columns, {x, y}); end
held = ishold;
newplot;
colors = get(gca, 'colororder');
[handles, entries] = deal(zeros(1, 0));
for k = 1:numel(curves)
  color = colors(mod(k - 1, size(colors, 1)) + 1, :);
  if curves(k).is_test
    handles(end + 1) = points_of(curves(k), x, y, color); %#ok<AGROW>
  else
    handles(end + 1) = line_of(curves(k), x, y, color); %#ok<AGROW>
  end
end
entries = [handles, keys_of_states(curves, x, y), events_of(curves, x, y)];
if strcmp(x, 'energy_j'), set(gca, 'xscale', 'log'); end
if ~held, limit(curves, x, y); end
xlabel(label_of(x, result));
ylabel(label_of(y, result));
grid on
box on
if numel(entries) > 1
  legend(entries, get(entries, 'displayname'), 'location', 'northeastoutside', 'interpreter', 'none');
end
if nargout == 0, clear handles; end
end

function [names, over] = arguments_of(given)
over = cell(1, 0);
names = given;
if numel(given) > 1 && strcmp(given{end - 1}, 'over')
  over = given{end};
  if ~iscell(over), over = {over}; end
  names = given(1:end - 2);
end
if ~any(numel(names) == [0, 2]) || ~all(cellfun(@(name) ischar(name) || isa(name, 'string'), names))
  error('nlmodes:run', 'the names of two columns were expected, or none, and perhaps ''over'' and a test behind them');
end
names = cellfun(@char, names, 'UniformOutput', false);
end

function curves = curves_of(result, names)
curves = nlmodes.internal.curves(result);
if ~isempty(curves) || ~isfield(result, 'transient') || isempty(result.transient), return; end
if isempty(names), names = {'time_s', 'displacement_m'}; end
expect_columns(result.transient, names);
curves = nlmodes.internal.histories(result.transient, names{:});
end

function curves = laid_over(over)
if isfield(over, 'branches')
  curves = nlmodes.internal.curves(over);
else
  curves = struct('name', 'test', 'columns', over, 'is_test', true);
end
end

function names = defaults_of(curves, with_test)
columns = curves(1).columns;
if isfield(columns, 'time_s') && isfield(columns, 'displacement_m')
  names = {'time_s', 'displacement_m'};
elseif isfield(columns, 'level') && with_test
  names = {'frequency_hz', 'modal_amplitude'};
elseif curves(1).is_test || with_test
  names = {'modal_amplitude', 'frequency_hz'};
elseif isfield(columns, 'level')
  names = {'frequency_hz', 'drive_fundamental_m'};
  known = @(curve) isfield(curve.columns, names{2}) && any(isfinite(curve.columns.(names{2})));
  % A base that moves has no drive point.
  if ~any(arrayfun(known, curves)), names{2} = 'fundamental_m'; end
else
  names = {'energy_j', 'frequency_hz'};
end
end

function expect_columns(columns, names)
for name = names(~isfield(columns, names))
  error('nlmodes:run', '%s is no column; there are: %s', name{1}, strjoin(fieldnames(columns)', ', '));
end
end

function handle = line_of(curve, x, y, color)
columns = curve.columns;
states = states_of(columns);
handle = piece(columns, x, y, states == 1, color, '-', 1.5);
set(handle, 'displayname', curve.name);
if isscalar(columns.(x)), set(handle, 'xdata', columns.(x), 'ydata', columns.(y), 'marker', '.'); end
if any(states == 2), hidden(piece(columns, x, y, states == 2, color, '--', 1.5)); end
if any(states == 3), hidden(piece(columns, x, y, states == 3, pale(color), '-', 0.5)); end
end

function states = states_of(columns)
% Of the parts between points: 1 stable, or not looked at; 2 unstable; 3 unknown; 0 left out.
names = fieldnames(columns);
states = ones(numel(columns.(names{1})) - 1, 1);
if isfield(columns, 'stable') && any(isfinite(columns.stable))
  stable = columns.stable(1:end - 1);
  states(stable == 0) = 2;
  states(isnan(stable)) = 3;
end
if isfield(columns, 'event')
  resumed = has_event(columns, 'resumed');
  states(resumed(2:end)) = 0;
end
end

function handle = piece(columns, x, y, own, color, style, width)
starts = find(diff([false; own]) == 1);
ends = find(diff([own; false]) == -1) + 1;
[xs, ys] = deal(NaN);
for k = 1:numel(starts)
  at = starts(k):ends(k);
  xs = [xs; columns.(x)(at); NaN]; %#ok<AGROW>
  ys = [ys; columns.(y)(at); NaN]; %#ok<AGROW>
end
handle = double(line(xs, ys, 'color', color, 'linestyle', style, 'linewidth', width));
end

function hidden(handle)
set(handle, 'handlevisibility', 'off');
end

function color = pale(color)
color = 0.5 * color + 0.5 * 0.75;
end

function keys = keys_of_states(curves, x, y)
% Entries of the legend, drawn as a point of a curve, since gnuplot needs one.
keys = zeros(1, 0);
ink = [0.13, 0.13, 0.13];
looks = {2, '--', 1.5, ink, 'unstable'; 3, '-', 0.5, pale(ink), 'stability unknown'};
curves = curves(~[curves.is_test]);
for k = 1:size(looks, 1)
  own = find(arrayfun(@(curve) any(states_of(curve.columns) == looks{k, 1}), curves), 1);
  if isempty(own), continue; end
  at = find(states_of(curves(own).columns) == looks{k, 1}, 1) * [1, 1];
  keys(end + 1) = double(line(curves(own).columns.(x)(at), curves(own).columns.(y)(at), 'linestyle', looks{k, 2}, ...
    'linewidth', looks{k, 3}, 'color', looks{k, 4}, 'displayname', looks{k, 5})); %#ok<AGROW>
end
end

function handle = points_of(curve, x, y, color)
columns = curve.columns;
[xs, ys] = deal(columns.(x), columns.(y));
[dx, dy] = deal(error_of(columns, x), error_of(columns, y));
none = NaN(size(xs));
bars = {reshape([xs - dx, xs + dx, none]', [], 1), reshape([ys, ys, none]', [], 1); ...
  reshape([xs, xs, none]', [], 1), reshape([ys - dy, ys + dy, none]', [], 1)};
for k = 1:2
  hidden(line(bars{k, 1}, bars{k, 2}, 'color', color, 'linewidth', 1.5));
end
handle = double(line(xs, ys, 'color', color, 'linestyle', 'none', 'marker', 'o', 'markersize', 5));
set(handle, 'markerfacecolor', color, 'displayname', curve.name);
end

function values = error_of(columns, name)
values = NaN(size(columns.(name)));
if isfield(columns, [name, '_uncertainty']), values = columns.([name, '_uncertainty']); end
end

function handles = events_of(curves, x, y)
% Markers as in the figures of the command line, as far as there are such.
markers = {'grazing', 'o'; 'lift-off', 'o'; 'start', '>'; 'fold', '^'; 'frequency-fold', 'p'; 'branch-point', 's'; ...
  'kink', 'd'; 'contact-change', 'v'; 'stability-change', '*'; 'period-doubling', 'h'; 'neimark-sacker', '<'; ...
  'tongue-foot', 'x'; 'resumed', '+'};
handles = zeros(1, 0);
curves = curves(arrayfun(@(curve) isfield(curve.columns, 'event'), curves));
if isempty(curves), return; end
all_of = @(curve) strsplit(strjoin(curve.columns.event(:)', ' '), ' ');
found = arrayfun(all_of, curves, 'UniformOutput', false);
found = unique([found{:}]);
for name = found(~cellfun('isempty', found))
  [xs, ys] = deal(zeros(0, 1));
  for k = 1:numel(curves)
    at = has_event(curves(k).columns, name{1});
    xs = [xs; curves(k).columns.(x)(at)]; %#ok<AGROW>
    ys = [ys; curves(k).columns.(y)(at)]; %#ok<AGROW>
  end
  marker = [markers(strcmp(name{1}, markers(:, 1)), 2); {'.'}];
  handles(end + 1) = double(line(xs, ys, 'linestyle', 'none', 'marker', marker{1}, 'markersize', 6, ...
    'color', [0.13, 0.13, 0.13], 'displayname', strrep(name{1}, '-', ' '))); %#ok<AGROW>
end
end

function yes = has_event(columns, name)
yes = cellfun(@(names) any(strcmp(name, strsplit(names, ' '))), columns.event(:));
end

function limit(curves, x, y)
% Modes beside responses go on far beyond them: the axes are those of the responses.
is_mode = arrayfun(@(curve) isfield(curve.columns, 'kind') && iscellstr(curve.columns.kind) ...
  && any(strcmp(curve.columns.kind{1}, {'damped-mode', 'mode'})), curves);
if all(is_mode) || ~any(is_mode), return; end
names = {x, y};
axes_of = {'xlim', 'ylim'};
for k = 1:2
  values = arrayfun(@(curve) curve.columns.(names{k})(:), curves(~is_mode), 'UniformOutput', false);
  values = vertcat(values{:});
  [low, high] = deal(min(values), max(values));
  if high > low, set(gca, axes_of{k}, [low, high] + 0.05 * (high - low) * [-1, 1]); end
end
end

function text = label_of(name, result)
text = nlmodes.internal.label(name);
if strcmp(name, 'level') && isfield(result, 'summary') && isfield(result.summary, 'level_unit')
  text = ['level in ', result.summary.level_unit];
end
end
