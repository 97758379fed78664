function scene = structure(K, M, varargin)
%NLMODES.STRUCTURE  A scene of stiffness and mass matrices, for nlmodes.run and nlmodes.check.
%
%   scene = nlmodes.structure(K, M)
%   scene = nlmodes.structure(K, M, 'dofs', dofs, 'folder', 'my_model', 'title', 'bracket')
%
% K (N/m) and M (kg) are symmetric n x n matrices, sparse or full, without the rows of supports. dofs has a row for each
% of theirs: node and component (1 to 6: ux, uy, uz, rotx, roty, rotz), and perhaps x, y, z of the node in m behind
% them. Left out, row i is node i, which moves along x.
%
% The matrices are written to model.mat and model.csv in 'folder', which is created; without one in a temporary
% directory, which is deleted when MATLAB ends. Where the folder holds other matrices, on which earlier results may
% depend, this is an error; 'force', true overwrites them.
%
% What the scene has to have besides is added as fields, with the keys of a scene file:
%
%   scene.contact(1) = struct('node', 3, 'normal', [1, 0, 0], 'gap_m', 1e-3);
%   scene.reduction.modes = 2;
%   scene.method.harmonics = 7;
%   result = nlmodes.run(scene);
options = nlmodes.internal.options(varargin, {'dofs', 'folder', 'title', 'force'});
K = matrix_of('K', K);
M = matrix_of('M', M);
n = size(K, 1);
if size(M, 1) ~= n
  error('nlmodes:scene', 'M is %d x %d; %d x %d was expected, as of K', size(M, 1), size(M, 1), n, n);
end
dofs = dofs_of(options.dofs, n);
folder = options.folder;
if isempty(folder), folder = nlmodes.internal.temporary(); end
if exist(folder, 'dir') ~= 7, mkdir(folder); end
folder = nlmodes.internal.absolute(folder);
model = fullfile(folder, 'model.mat');
table = fullfile(folder, 'model.csv');
if isempty(options.force) || ~options.force
  expect_the_same(model, K, M, table, dofs);
end
if ~isfile(model) || ~is_same(model, K, M)
  save(model, 'K', 'M', '-v6');
end
write_text(table, text_of_dofs(dofs));
if isempty(options.title), options.title = 'structure from matrices'; end
scene = struct('title', char(options.title));
scene.structure = struct('kind', 'matrices', 'stiffness', [model, '#K'], 'mass', [model, '#M'], 'dofs', table);
end

function matrix = matrix_of(name, given)
shape = strjoin(arrayfun(@num2str, size(given), 'UniformOutput', false), ' x ');
if ~isfloat(given) || ndims(given) > 2 || size(given, 1) ~= size(given, 2) || isempty(given) %#ok<ISMAT>
  why = '';
  if isinteger(given), why = ', whose values are rounded to whole numbers'; end
  error('nlmodes:scene', '%s is %s of %s%s; a real matrix of doubles with as many rows as columns was expected', ...
    name, class(given), shape, why);
end
if ~isreal(given)
  [~, at] = max(abs(imag(given(:))));
  [row, column] = ind2sub(size(given), at);
  error('nlmodes:scene', ['%s is complex, %s(%d, %d) has the imaginary part %g; a real matrix was expected: ', ...
    'real(%s), and damping as scene.damping'], name, name, row, column, full(imag(given(row, column))), name);
end
matrix = sparse(double(given));
[row, column, value] = find(matrix);
bad = find(~isfinite(value), 1);
if ~isempty(bad)
  error('nlmodes:scene', '%s(%d, %d) is %g; finite numbers were expected', name, row(bad), column(bad), value(bad));
end
expect_symmetric(name, matrix);
end

function expect_symmetric(name, matrix)
% As the command line: differences of 1e-10 are rounding, beside the diagonal and the entries themselves.
[row, column, difference] = find(tril(matrix - matrix'));
if isempty(row), return; end
entries = @(i, j) full(matrix(sub2ind(size(matrix), i, j)));
diagonal = sqrt(abs(full(diag(matrix))));
scale = max([diagonal(row) .* diagonal(column), abs(entries(row, column)), abs(entries(column, row))], [], 2);
bad = find(abs(difference) > 1e-10 * scale);
if isempty(bad), return; end
[~, largest] = max(abs(difference(bad)));
[i, j] = deal(column(bad(largest)), row(bad(largest)));
error('nlmodes:scene', ['%s is not symmetric: %s(%d, %d) is %.12g and %s(%d, %d) is %.12g, which is the largest ', ...
  'difference; (%s + %s'')/2 is symmetric, if it comes from rounding'], ...
  name, name, i, j, full(matrix(i, j)), name, j, i, full(matrix(j, i)), name, name);
end

function dofs = dofs_of(given, n)
if isempty(given), given = [(1:n)', ones(n, 1)]; end
dofs = double(given);
if size(dofs, 1) ~= n || ~any(size(dofs, 2) == [2, 5])
  error('nlmodes:scene', 'dofs is %d x %d; %d x 2 (node, component) or %d x 5 (with x, y, z) was expected', ...
    size(dofs, 1), size(dofs, 2), n, n);
end
expect_rows(dofs, 1, dofs(:, 1) >= 0 & dofs(:, 1) == fix(dofs(:, 1)), 'the number of a node');
expect_rows(dofs, 2, ismember(dofs(:, 2), 1:6), 'a component from 1 to 6 (ux, uy, uz, rotx, roty, rotz)');
for column = 3:size(dofs, 2)
  expect_rows(dofs, column, isfinite(dofs(:, column)), 'a coordinate in m');
end
[~, firsts, which] = unique(dofs(:, 1:2), 'rows', 'first');
again = find(firsts(which) ~= (1:n)', 1);
if ~isempty(again)
  error('nlmodes:scene', 'dofs has node %d, component %d in row %d and in row %d; each may occur once', ...
    dofs(again, 1), dofs(again, 2), firsts(which(again)), again);
end
end

function expect_rows(dofs, column, good, expected)
bad = find(~good, 1);
if ~isempty(bad)
  error('nlmodes:scene', 'dofs(%d, %d) is %g; %s was expected', bad, column, dofs(bad, column), expected);
end
end

function expect_the_same(model, K, M, table, dofs)
other = '';
if isfile(model) && ~is_same(model, K, M)
  other = sprintf('%s holds other matrices', model);
elseif isfile(table) && ~strcmp(nlmodes.internal.text_of(table), text_of_dofs(dofs))
  other = sprintf('%s holds other nodes or components', table);
end
if ~isempty(other)
  error('nlmodes:scene', ['%s, on which earlier results may depend; another ''folder'' was expected, or ', ...
    '''force'', true to overwrite it'], other);
end
end

function yes = is_same(model, K, M)
% A file that cannot be read is not of these matrices.
yes = false;
try
  stored = load(model, '-mat');
  yes = all(isfield(stored, {'K', 'M'})) && isequal(stored.K, K) && isequal(stored.M, M);
catch
end
end

function text = text_of_dofs(dofs)
names = {'node', 'component', 'x', 'y', 'z'};
format = ['%d,%d,%d', repmat(',%.17g', 1, size(dofs, 2) - 2), '\n'];
text = [strjoin([{'row'}, names(1:size(dofs, 2))], ','), char(10), sprintf(format, [1:size(dofs, 1); dofs'])];
end

function write_text(file, text)
out = nlmodes.internal.open(file, 'w');
done = onCleanup(@() fclose(out));
fprintf(out, '%s', text);
end
