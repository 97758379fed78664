function scene = structure(K, M, varargin)
%NLMODES.STRUCTURE  A scene of stiffness and mass matrices, for nlmodes.run and nlmodes.check.
%
%   scene = nlmodes.structure(K, M)
%   scene = nlmodes.structure(K, M, 'dofs', dofs, 'folder', 'my_model', 'title', 'bracket')
%
% K (N/m) and M (kg) are symmetric n x n matrices, sparse or full, without the rows of supports. dofs has a row for each
% of theirs: node and component (1 to 6: ux, uy, uz, rotx, roty, rotz), and perhaps x, y, z of the node in m behind
% them. Left out, row i is node i, which moves along x. The matrices are written to model.mat and model.csv in 'folder',
% which is created; without one in a temporary directory.
%
% What the scene has to have besides is added as fields, with the keys of a scene file:
%
%   scene.contact(1) = struct('node', 3, 'normal', [1, 0, 0], 'gap_m', 1e-3);
%   scene.reduction.modes = 2;
%   scene.method.harmonics = 7;
%   result = nlmodes.run(scene);
options = nlmodes.internal.options(varargin, {'dofs', 'folder', 'title'});
K = matrix_of('K', K);
M = matrix_of('M', M);
n = size(K, 1);
if size(M, 1) ~= n
  error('nlmodes:scene', 'M is %d x %d; %d x %d was expected, as of K', size(M, 1), size(M, 1), n, n);
end
dofs = dofs_of(options.dofs, n);
folder = options.folder;
if isempty(folder), folder = tempname; end
if exist(folder, 'dir') ~= 7, mkdir(folder); end
folder = nlmodes.internal.absolute(folder);
model = fullfile(folder, 'model.mat');
save(model, 'K', 'M', '-v6');
table = fullfile(folder, 'model.csv');
write_dofs(table, dofs);
if isempty(options.title), options.title = 'structure from matrices'; end
scene = struct('title', char(options.title));
scene.structure = struct('kind', 'matrices', 'stiffness', [model, '#K'], 'mass', [model, '#M'], 'dofs', table);
end

function matrix = matrix_of(name, given)
if ~isnumeric(given) || ~isreal(given) || ndims(given) > 2 || size(given, 1) ~= size(given, 2) || isempty(given)
  error('nlmodes:scene', '%s is %s of %s; a real matrix with as many rows as columns was expected', ...
    name, class(given), strjoin(arrayfun(@num2str, size(given), 'UniformOutput', false), ' x '));
end
matrix = sparse(double(given));
[row, column, value] = find(matrix);
bad = find(~isfinite(value), 1);
if ~isempty(bad)
  error('nlmodes:scene', '%s(%d, %d) is %g; finite numbers were expected', name, row(bad), column(bad), value(bad));
end
end

function dofs = dofs_of(given, n)
if isempty(given), given = [(1:n)', ones(n, 1)]; end
dofs = double(given);
if size(dofs, 1) ~= n || ~any(size(dofs, 2) == [2, 5])
  error('nlmodes:scene', 'dofs is %d x %d; %d x 2 (node, component) or %d x 5 (with x, y, z) was expected', ...
    size(dofs, 1), size(dofs, 2), n, n);
end
end

function write_dofs(file, dofs)
names = {'node', 'component', 'x', 'y', 'z'};
out = nlmodes.internal.open(file, 'w');
done = onCleanup(@() fclose(out));
fprintf(out, '%s\n', strjoin([{'row'}, names(1:size(dofs, 2))], ','));
format = ['%d,%d,%d', repmat(',%.17g', 1, size(dofs, 2) - 2), '\n'];
fprintf(out, format, [1:size(dofs, 1); dofs']);
end
