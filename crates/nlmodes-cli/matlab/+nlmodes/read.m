function result = read(folder, varargin)
%NLMODES.READ  Results that a run has left in a directory.
%
%   result = nlmodes.read('results/rod')
%   result = nlmodes.read('results/rod', 'arrays', false)  without the arrays of the npz files
%
% Fields of the result:
%   folder         the directory
%   summary        summary.json as a structure; its key `end` is the field xEnd, since `end` is a keyword
%   branches       one for each branch: name, folder, summary, and
%     branch         branch.csv: a column vector for each column; texts are cell arrays, unknown numbers NaN
%     contacts       contacts.csv, a row a point and stop
%     participation  participation.csv
%     harmonics      harmonics.npz: omega (P x 1), coefficients (P x D x H+1), ...
%     histories      histories.npz: time_s (P x T), force_n (P x C x T), ...
%   branch         that of the first branch, for short
%   points         modal_points.csv of records and virtual tests
%   damping_by_harmonic, decay
%                  further tables of records
%   overlay, response_overlay
%                  what was laid over, beside the computed curve
%   transient      transient.npz of motions in time: time_s (T x 1), place, displacement_m (P x T), force_n (C x T), ...
%   touches        touches.csv of motions in time, a row a touch
%   complete, ended_because
%                  whether every branch reached an end that the scene names, and why the first incomplete one, else
%                  the last, ended
%
% `nlmodes-cli columns` prints the meaning of every file, column and array, with units and signs. What a run did not
% write is [].
options = nlmodes.internal.options(varargin, {'arrays'});
arrays = isempty(options.arrays) || options.arrays;
folder = char(folder);
if exist(folder, 'dir') ~= 7
  error('nlmodes:run', '%s: there is no such directory', folder);
end
summary = nlmodes.internal.json(folder);
[places, names] = nlmodes.internal.places_of(folder, summary);
result = struct('folder', folder, 'summary', summary, 'branches', [], 'branch', []);
for k = 1:numel(places)
  result.branches = [result.branches; nlmodes.internal.read_branch(folder, places{k}, names{k}, arrays)];
end
if ~isempty(places)
  result.branch = result.branches(1).branch;
end
table = @(name) nlmodes.internal.optional(@nlmodes.internal.csv, fullfile(folder, [name, '.csv']), true);
result.points = table('modal_points');
for name = {'damping_by_harmonic', 'decay', 'overlay', 'response_overlay'}
  result.(name{1}) = table(name{1});
end
file = fullfile(folder, 'transient.npz');
result.transient = nlmodes.internal.optional(@nlmodes.internal.npz, file, arrays);
result.touches = table('touches');
if isempty(places) && isempty(result.points) && ~isfile(file)
  error('nlmodes:run', '%s holds no results of nlmodes', folder);
end
[result.complete, result.ended_because] = nlmodes.internal.ends_of(result.summary);
end
