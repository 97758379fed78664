function handles = plot(result, x, y)
%NLMODES.PLOT  Branches of a result in the current axes.
%
% Frequency over energy; of responses the amplitude of the drive point over frequency.
%
%   nlmodes.plot(result)
%   nlmodes.plot(result, 'frequency_hz', 'peak_contact_force_n')      any two columns of branch.csv
%   handles = nlmodes.plot(...)                                       one for each curve, for legend
%
% Events (grazing, folds, kinks, branch points, ...) are marked.
curves = nlmodes.internal.curves(result);
if isempty(curves)
  error('nlmodes:run', '%s holds no branch', result.folder);
end
response = isfield(curves(1).columns, 'level');
if nargin < 3
  defaults = {'energy_j', 'frequency_hz'; 'frequency_hz', 'drive_fundamental_m'};
  [x, y] = defaults{1 + response, :};
end
expect_columns(curves(1).columns, {x, y});
colors = get(gca, 'colororder');
if ~ishold, cla; end
handles = zeros(1, 0);
for k = 1:numel(curves)
  columns = curves(k).columns;
  color = colors(mod(k - 1, size(colors, 1)) + 1, :);
  handles(end + 1) = line_of(columns, x, y, color, curves(k).name); %#ok<AGROW>
  marked(columns, x, y, color);
end
if strcmp(x, 'energy_j'), set(gca, 'xscale', 'log'); end
xlabel(nlmodes.internal.label(x));
ylabel(nlmodes.internal.label(y));
grid on
box on
if numel(handles) > 1, legend(handles, {curves.name}, 'location', 'best', 'interpreter', 'none'); end
if nargout == 0, clear handles; end
end

function expect_columns(columns, names)
for name = names(~isfield(columns, names))
  error('nlmodes:run', '%s is no column; there are: %s', name{1}, strjoin(fieldnames(columns)', ', '));
end
end

function handle = line_of(columns, x, y, color, name)
handle = double(line(columns.(x), columns.(y), 'color', color, 'linewidth', 1.5));
set(handle, 'displayname', name);
end

function marked(columns, x, y, color)
at = find(~cellfun('isempty', columns.event));
if isempty(at), return; end
points = line(columns.(x)(at), columns.(y)(at), 'linestyle', 'none', 'marker', 'o', 'color', color);
set(points, 'markersize', 5, 'markerfacecolor', 'w');
set(points, 'handlevisibility', 'off');
end
