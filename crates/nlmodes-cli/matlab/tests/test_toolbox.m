function test_toolbox(root)
% Tests of the toolbox beside the command line: `test_toolbox(root)`, with the root of the repository. Each is a
% function of this file.
tests = { ...
  @numbers_are_those_of_the_binary_file, ...
  @columns_are_those_of_the_text, ...
  @a_run_writes_what_the_command_line_writes, ...
  @structures_of_scenes_are_the_scenes, ...
  @parts_are_in_the_order_of_the_summary, ...
  @mistakes_have_the_text_of_the_command_line, ...
  @matrices_arrive_to_the_last_bit, ...
  @single_values_of_lists_are_lists, ...
  @paths_are_those_of_the_current_folder, ...
  @a_missing_program_is_named, ...
  @curves_of_responses_are_told_apart, ...
  @the_plot_names_missing_columns, ...
  @what_the_command_line_prints_is_shown, ...
  @reservations_are_warnings, ...
  @a_branch_that_ends_early_is_read, ...
  @records_are_those_of_the_command_line, ...
  @records_of_a_structure_are_those_of_their_formula, ...
  @motions_in_time_are_those_of_the_command_line, ...
  @other_matrices_are_not_overwritten, ...
  @mistakes_in_matrices_have_their_rows, ...
  @curves_are_drawn_by_their_stability, ...
  @tests_are_drawn_over_curves, ...
  @nothing_is_left_in_the_temporary_folder};
place = tempname;
mkdir(place);
before = cd(place);
failed = 0;
for k = 1:numel(tests)
  name = func2str(tests{k});
  try
    tests{k}(root);
    fprintf('ok      %s\n', name);
  catch problem
    failed = failed + 1;
    fprintf('FAILED  %s: %s\n', name, problem.message);
  end
end
cd(before);
removed(place);
fprintf('%d of %d passed\n', numel(tests) - failed, numel(tests));
if failed > 0, error('nlmodes:test', '%d tests failed', failed); end
end

function numbers_are_those_of_the_binary_file(root)
% The same numbers twice: as texts of the tables and NumPy arrays, read here, and as doubles in results.mat, read by the
% language itself.
result = nlmodes.run(scene_of(root, 'beam_responses'), 'out', 'responses', 'output.matlab', true, ...
  'response.0.levels_n', [5, 20], 'quiet', true);
binary = load(fullfile('responses', 'results.mat'));
for name = fieldnames(binary.branch)'
  same(name{1}, result.branch.(name{1}), binary.branch.(name{1}));
end
for table = {'harmonics', 'histories'}
  for name = fieldnames(binary.(table{1}))'
    same(name{1}, result.branches.(table{1}).(name{1}), binary.(table{1}).(name{1}));
  end
end
expect(numel(result.branch.point) > 100 && iscellstr(result.branch.event), 'the table is not that of the responses');
end

function columns_are_those_of_the_text(~)
file = fopen('table.csv', 'w');
fprintf(file, 'point,event,x_m,stable,2nd,name\n0,,0.1,true,,"a, b"\n');
fprintf(file, '1,fold kink,1.7976931348623157e308,,5e-324,"say ""c"""\n');
fclose(file);
table = nlmodes.internal.csv('table.csv');
same('point', table.point, [0; 1]);
same('event', table.event, {''; 'fold kink'});
same('x_m', table.x_m, [0.1; realmax]);
same('stable', table.stable, [1; NaN]);
same('2nd', table.x_2nd, [NaN; 2 ^ -1074]);
same('name', table.name, {'a, b'; 'say "c"'});
end

function a_run_writes_what_the_command_line_writes(root)
result = nlmodes.run(scene_of(root, 'rod'), 'out', 'ours', 'method.harmonics', 5, 'quiet', true);
same_files(result.folder, command_line_run(scene_of(root, 'rod'), '--set method.harmonics=5'));
expect(result.complete && ~isempty(strfind(result.ended_because, 'Hz')), 'the end is not that of the summary');
end

function structures_of_scenes_are_the_scenes(root)
scene = struct('title', 'Rod "in" words');
scene.structure = struct('kind', 'rod', 'length_m', 1, 'elements', 8, 'start', 'clamped');
scene.structure.material = struct('youngs_modulus_pa', 210e9, 'density_kg_m3', 7812.3);
scene.structure.section.area_m2 = 1e-4;
scene.contact = struct('at_m', 1, 'direction', 'axial', 'side', {'positive'; 'negative'}, 'gap_m', {1e-3; 1 / 3});
scene.method.harmonics = 5;
scene.continuation = struct('max_energy_ratio', 3, 'frequency_hz', [1e3, 2e3]);
text = sprintf(['title = "Rod \\"in\\" words"\n', ...
  '[structure]\nkind = "rod"\nlength_m = 1.0\nelements = 8\nstart = "clamped"\n', ...
  '[structure.material]\nyoungs_modulus_pa = 210e9\ndensity_kg_m3 = 7812.3\n[structure.section]\narea_m2 = 1e-4\n', ...
  '[[contact]]\nat_m = 1.0\ndirection = "axial"\nside = "positive"\ngap_m = 1e-3\n', ...
  '[[contact]]\nat_m = 1.0\ndirection = "axial"\nside = "negative"\ngap_m = 0.3333333333333333\n', ...
  '[method]\nharmonics = 5\n[continuation]\nmax_energy_ratio = 3.0\nfrequency_hz = [1e3, 2e3]\n']);
write('by_hand.toml', text);
result = nlmodes.run(scene, 'quiet', true);
same_files(result.folder, command_line_run('by_hand.toml', ''));
expect(numel(result.branch.point) > 5, 'hardly a branch');
end

function parts_are_in_the_order_of_the_summary(root)
result = nlmodes.run(scene_of(root, 'rod'), 'out', 'parts', 'method.harmonics', [3, 1], 'quiet', true);
same('names', sort({result.branches.name}), {'MS-HBM, 1 harmonic', 'MS-HBM, 3 harmonics'});
for k = 1:2
  told = result.summary.branches(k);
  same('name', result.branches(k).name, told.label);
  same('harmonics', size(result.branches(k).harmonics.coefficients, 3), told.harmonics + 1);
end
same('the first', result.branch, result.branches(1).branch);
end

function mistakes_have_the_text_of_the_command_line(root)
scene = fileread(scene_of(root, 'rod'));
write('wrong.toml', strrep(scene, 'gap_m', 'gapm'));
[~, said] = system(['"', nlmodes.program(), '" run wrong.toml --quiet 2>&1']);
printed = evalc('raised = raised_by(@() nlmodes.run(''wrong.toml''));');
same('printed', printed, '');
same('identifier', raised.identifier, 'nlmodes:scene');
same('text', raised.message, strtrim(said));
raised = raised_by(@() nlmodes.check('wrong.toml'));
expect(~isempty(strfind(raised.message, 'did you mean `gap_m`?')), raised.message);
raised = raised_by(@() nlmodes.run('wrong.toml', 'colour', 3));
expect(~isempty(strfind(raised.message, 'unknown option `colour`')), raised.message);
raised = raised_by(@() nlmodes.read('nowhere'));
same('text', raised.message, 'nowhere: there is no such directory');
end

function matrices_arrive_to_the_last_bit(~)
% Two masses: the linear frequency of the scene is that of the matrices, whose entries have no short decimal text.
K = [pi * 1e6, -1e6 / 3; -1e6 / 3, 2e6 * exp(1)];
M = [1 / 3, 0; 0, sqrt(2)];
scene = nlmodes.structure(K, M, 'folder', 'model', 'dofs', [4, 1; 7, 1]);
scene.contact = struct('node', 4, 'normal', [1, 0, 0], 'gap_m', 1e-3);
scene.reduction.modes = 1;
scene.method.harmonics = 5;
scene.continuation.max_energy_ratio = 2;
stored = load(fullfile('model', 'model.mat'));
same('K', full(stored.K), K);
same('M', full(stored.M), M);
result = nlmodes.run(scene, 'quiet', true);
expected = sqrt(min(eig(K, M))) / (2 * pi);
expect(abs(result.branch.frequency_hz(1) / expected - 1) < 1e-12, 'the grazing frequency is not that of the matrices');
raised = raised_by(@() nlmodes.structure(K, M(1)));
same('text', raised.message, 'M is 1 x 1; 2 x 2 was expected, as of K');
raised = raised_by(@() nlmodes.structure([1, NaN; NaN, 1], M));
same('text', raised.message, 'K(2, 1) is NaN; finite numbers were expected');
end

function single_values_of_lists_are_lists(~)
response = struct('levels_n', 10, 'frequency_hz', 3);
text = nlmodes.internal.toml(struct('force', struct('at_m', 0.5), 'response', response));
same('text', text, sprintf('\n[[force]]\nat_m = 0.5\n\n[response]\nlevels_n = [10]\nfrequency_hz = 3\n'));
% Every key of a scene that takes nothing but lists of numbers is known as one.
[~, schema] = system(['"', nlmodes.program(), '" schema']);
names = {'levels_n', 'levels_m_s2', 'positions_m', 'ratios', 'damping_ratios', 'histories', 'accelerometers_m'};
for name = names
  expect(~isempty(strfind(schema, ['"', name{1}, '"'])), [name{1}, ' is no key of a scene']);
  expect(nlmodes.internal.is_list(name{1}, 1), [name{1}, ' is not known as a list']);
end
same('value', nlmodes.internal.toml_value([1, 0.1; 1e300, -3], ''), '[[1, 0.1], [1e+300, -3]]');
same('value', nlmodes.internal.toml_value([1; 2], 'linear_modes.shapes'), '[[1], [2]]');
same('value', nlmodes.internal.toml_value(3, 'shapes'), '[[3]]');
raised = raised_by(@() nlmodes.internal.toml_value(1 + 2i, 'force.amplitude_n'));
expect(~isempty(strfind(raised.message, '`force.amplitude_n` is complex')), raised.message);
law = struct('polynomial', [0, 0, 6e9]);
same('value', nlmodes.internal.toml_value(law, 'law'), '{ polynomial = [0, 0, 6000000000] }');
end

function paths_are_those_of_the_current_folder(root)
write('here.txt', 'x');
scene = nlmodes.internal.with_absolute_paths(struct('a', struct('mass', 'here.txt#M'), 'kind', 'rod', 'b', 'not.here'));
same('path', scene.a.mass, [fullfile(pwd, 'here.txt'), '#M']);
same('texts', {scene.kind, scene.b}, {'rod', 'not.here'});
overlay = nlmodes.internal.with_absolute_paths(struct('overlay', struct('path', 'no_such_folder', 'label', 'x')));
same('folder', overlay.overlay, struct('path', fullfile(pwd, 'no_such_folder'), 'label', 'x'));
same('value', nlmodes.internal.with_absolute_paths('a/b.npz#c', 'transient.load.0.table'), fullfile(pwd, 'a/b.npz#c'));
% A folder of results, laid over: the same as with its path from the root.
nlmodes.run(scene_of(root, 'rod'), 'out', 'laid_over', 'method.harmonics', 3, 'quiet', true);
scene = small_rod();
scene.overlay = struct('path', 'laid_over', 'label', 'another');
ours = nlmodes.run(scene, 'out', 'relative', 'quiet', true);
scene.overlay.path = fullfile(pwd, 'laid_over');
theirs = nlmodes.run(scene, 'out', 'absolute', 'quiet', true);
expect(numel(ours.overlay.frequency_hz) > 0, 'nothing was laid over');
same('overlay', ours.overlay, theirs.overlay);
other = nlmodes.run(scene, 'out', 'replaced', 'overlay.0.path', 'laid_over', 'quiet', true);
same('overlay', other.overlay, theirs.overlay);
end

function a_missing_program_is_named(root)
own = nlmodes.program();
back = onCleanup(@() nlmodes.program(own));
nlmodes.program('/nowhere/nlmodes-cli');
raised = raised_by(@() nlmodes.run(scene_of(root, 'rod')));
same('identifier', raised.identifier, 'nlmodes:run');
expect(~isempty(strfind(raised.message, '/nowhere/nlmodes-cli cannot be run')), raised.message);
end

function curves_of_responses_are_told_apart(~)
columns = struct('curve', [0; 0; 1], 'name', {{'5 N'; '5 N'; '20 N'}}, 'peak_m', [1; 2; 3]);
curves = nlmodes.internal.curves(struct('branches', struct('name', '', 'branch', columns)));
same('names', {curves.name}, {'5 N', '20 N'});
same('values', curves(1).columns.peak_m, [1; 2]);
end

function the_plot_names_missing_columns(~)
% Without a figure: what can be said is said before anything is drawn.
columns = struct('energy_j', 1, 'frequency_hz', 2, 'event', {{''}});
result = struct('folder', 'x', 'branches', struct('name', '', 'branch', columns));
raised = raised_by(@() nlmodes.plot(result, 'energy_j', 'colour'));
same('text', raised.message, 'colour is no column; there are: energy_j, frequency_hz, event');
end

function what_the_command_line_prints_is_shown(root)
scene = scene_of(root, 'beam_responses');
said = evalc(['nlmodes.run(scene, ''out'', ''shown'', ''response.0.levels_n'', 5, ', ...
  '''output.stability'', ''never'');']);
options = '--set response.0.levels_n=[5] --set output.stability=\"never\" --out not_shown';
[~, expected] = system(sprintf('"%s" run "%s" %s 2>&1', nlmodes.program(), scene, options));
% Lines without times and folders: peaks, jumps, estimated errors.
lines = strsplit(without_times(strrep(expected, 'not_shown', fullfile(pwd, 'shown'))), char(10));
lines = lines(~cellfun('isempty', regexp(lines, '^(?!warning).', 'once')));
for k = 1:numel(lines)
  expect(~isempty(strfind(without_times(said), lines{k})), ['not shown: ', lines{k}]);
end
expect(~isempty(strfind(said, 'Estimated errors')) && ~isempty(strfind(said, 'largest amplitude')), said);
said = evalc('nlmodes.run(scene_of(root, ''rod''), ''out'', ''still'', ''method.harmonics'', 3, ''quiet'', true);');
same('quiet', said, '');
end

function text = without_times(text)
text = regexprep(text, '\d+\.\d+ s|\d+ s\>', 'T');
end

function reservations_are_warnings(root)
before = warning('on', 'nlmodes:warning');
back = onCleanup(@() warning(before));
% As much of the stability as there is time for: what is not known is said of each level.
said = evalc(['result = nlmodes.run(scene_of(root, ''beam_responses''), ''out'', ''hasty'', ', ...
  '''response.0.levels_n'', [5, 20], ''output.stability_budget_s'', 1e-3, ''quiet'', true);']);
curves = result.summary.curves;
hasty = 0;
for k = 1:numel(curves)
  reason = regexp(curves(k).xEnd.message, 'the stability of .* was left out, its time was used up', 'match', 'once');
  if isempty(reason), continue; end
  hasty = hasty + 1;
  expect(~isempty(strfind(said, ['warning: ', curves(k).name, ': ', reason])), said);
end
expect(hasty > 1, 'there was time for all');
text = sprintf(['5 N: largest amplitude 1 mm\n', ...
  '    stability is known at 8.4 %% of the points only: elsewhere no jump is seen (output.stability_budget_s)\n', ...
  'run.csv: 3 periods\n  lag 90\n  finding offset: force without contact\nwarning: a b\n  | c\nResults in x\n']);
said = evalc('nlmodes.internal.warn(text);');
for expected = {'5 N: stability is known at 8.4 % of the points only: elsewhere no jump is seen', ...
    'run.csv: finding offset: force without contact', sprintf('a b\n  | c')}
  expect(~isempty(strfind(said, expected{1})), said);
end
same('number', numel(regexp(said, 'warning: (?!called from)')), 3);
end

function a_branch_that_ends_early_is_read(root)
result = nlmodes.run(scene_of(root, 'rod'), 'out', 'early', 'method.harmonics', 3, 'continuation.max_points', 5, ...
  'quiet', true);
same('points', result.branch.point, (0:4)');
expect(~result.complete && ~isempty(strfind(result.ended_because, 'limit of 5 points')), result.ended_because);
end

function records_are_those_of_the_command_line(root)
test = nlmodes.extract(scene_of(root, 'measured_record'), 'out', 'measured', 'quiet', true);
[status, said] = system(sprintf('"%s" experiment extract "%s" --quiet --out told 2>&1', nlmodes.program(), ...
  scene_of(root, 'measured_record')));
expect(status == 0, said);
same_bytes('measured', 'told', {'modal_points.csv', 'damping_by_harmonic.csv'});
same('records', numel(test.points.frequency_hz), 2);
same('harmonics', isempty(test.damping_by_harmonic), false);
again = nlmodes.read('measured');
same('the same again', again.points, test.points);
% The known values of these records.
[found, error_of] = deal(test.points.contact_stiffness_n_m(2), test.points.contact_stiffness_n_m_uncertainty(2));
expect(abs(found - 2e5) < 6 * error_of, 'the stiffness of the stop is not that of the records');
raised = raised_by(@() nlmodes.extract(scene_of(root, 'rod'), 'quiet', true));
same('identifier', raised.identifier, 'nlmodes:scene');
end

function records_of_a_structure_are_those_of_their_formula(~)
% A mass on a spring in resonance: a quarter of a period behind the force, with the amplitude phi F / (2 zeta omega^2).
[f, zeta, phi] = deal(20, 0.01, 1.5);
omega = 2 * pi * f;
time = (0:1 / 4000:2)';
force = 0.5 * cos(omega * time);
x = phi ^ 2 * 0.5 / (2 * zeta * omega ^ 2) * sin(omega * time);
mkdir('rig');
save(fullfile('rig', 'run.mat'), 'time', 'force', 'x', '-v6');
scene = struct('title', 'Mass on a spring');
scene.recording = struct('files', fullfile('rig', 'run.mat'), 'time_column', 'time');
scene.channel = struct('name', {'force', 'x'}, 'quantity', {'force', 'displacement'}, ...
  'role', {'excitation', 'drive-point'}, 'position_m', 0.2);
scene.linear_modes = struct('frequencies_hz', f, 'damping_ratios', zeta, 'positions_m', 0.2, 'shapes', phi);
test = nlmodes.extract(scene, 'quiet', true);
near = @(name, value) abs(test.points.(name) / value - 1) < 1e-6;
expect(near('frequency_hz', f) && near('damping', zeta) && near('lag_deg', 90), 'it is not that of the mass');
expect(near('modal_amplitude', phi * 0.5 / (2 * zeta * omega ^ 2)), 'the amplitude is not that of the mass');
end

function motions_in_time_are_those_of_the_command_line(root)
options = '--set transient.duration_s=4';
result = nlmodes.run(scene_of(root, 'beam_sweep'), 'out', 'sweep', 'transient.duration_s', 4, 'quiet', true);
same_bytes('sweep', command_line_run(scene_of(root, 'beam_sweep'), options), {'transient.npz', 'touches.csv'});
motion = result.transient;
n = numel(motion.time_s);
same('sizes', {size(motion.displacement_m), size(motion.force_n)}, {[numel(motion.place), n], [1, n]});
expect(max(abs(motion.time_s - (0:n - 1)' / result.summary.sample_rate_hz)) < 1e-12, 'times are not even');
% Numbers of the table as the language reads them itself.
table = dlmread(fullfile('sweep', 'touches.csv'), ',', 1, 0);
names = {'contact', 'instant_s', 'duration_s', 'impulse_ns', 'approach_velocity_m_s'};
same('touches', numel(fieldnames(result.touches)), numel(names));
for k = 1:numel(names), same(names{k}, result.touches.(names{k}), table(:, k)); end
expect(size(table, 1) > 5, 'hardly a touch');
% The force is that of the touches: zero between them.
inside = false(n, 1);
for k = 1:size(table, 1)
  inside = inside | (motion.time_s >= table(k, 2) & motion.time_s <= table(k, 2) + table(k, 3));
end
expect(all(motion.force_n(~inside) == 0) && any(motion.force_n(inside) > 0), 'forces are not those of the touches');
curves = nlmodes.internal.histories(motion, 'time_s', 'force_n');
same('force', curves.columns.force_n, motion.force_n');
same('name', curves.name, motion.place{end});
expect(result.complete, 'it is not complete');
end

function other_matrices_are_not_overwritten(~)
[K, M] = deal([2, -1; -1, 2] * pi, eye(2));
nlmodes.structure(K, M, 'folder', 'kept');
before = bytes_of(fullfile('kept', 'model.mat'));
nlmodes.structure(K, sparse(M), 'folder', 'kept');
raised = raised_by(@() nlmodes.structure(1.2 * K, M, 'folder', 'kept'));
same('identifier', raised.identifier, 'nlmodes:scene');
expect(~isempty(strfind(raised.message, 'model.mat holds other matrices')), raised.message);
raised = raised_by(@() nlmodes.structure(K, M, 'folder', 'kept', 'dofs', [1, 1; 1, 2]));
expect(~isempty(strfind(raised.message, 'model.csv holds other nodes or components')), raised.message);
same('file', bytes_of(fullfile('kept', 'model.mat')), before);
nlmodes.structure(1.2 * K, M, 'folder', 'kept', 'force', true);
stored = load(fullfile('kept', 'model.mat'));
same('K', full(stored.K), 1.2 * K);
end

function mistakes_in_matrices_have_their_rows(~)
K = toeplitz([4, -1, 0, 0, 0]);
M = eye(5);
messages = { ...
  changed(K, 3, 5, 2.5), M, 'K is not symmetric: K(3, 5) is 2.5 and K(5, 3) is 0, which is the largest difference'; ...
  changed(changed(K, 1, 2, -1.01), 4, 5, -2), M, 'K is not symmetric: K(4, 5) is -2 and K(5, 4) is -1'; ...
  sparse(changed(K, 2, 4, -3i)), M, 'K is complex, K(2, 4) has the imaginary part -3'; ...
  int32(K), M, 'K is int32 of 5 x 5, whose values are rounded to whole numbers'; ...
  K(:, 1:3), M, 'K is double of 5 x 3; a real matrix'; ...
  K, M(1:4, 1:4), 'M is 4 x 4; 5 x 5 was expected'; ...
  K, changed(M, 2, 2, Inf), 'M(2, 2) is Inf; finite numbers'};
for k = 1:size(messages, 1)
  raised = raised_by(@() nlmodes.structure(messages{k, 1:2}));
  same('identifier', raised.identifier, 'nlmodes:scene');
  expect(~isempty(strfind(raised.message, messages{k, 3})), raised.message);
end
% What the command line takes for rounding, it is here too.
nlmodes.structure(changed(K, 1, 2, -1 - 3e-10), M);
raised_by(@() nlmodes.structure(changed(K, 1, 2, -1 - 5e-10), M));
dofs = [(1:5)', ones(5, 1)];
messages = {changed(dofs, 4, 2, 0), 'dofs(4, 2) is 0; a component from 1 to 6'; ...
  changed(dofs, 2, 1, 1.5), 'dofs(2, 1) is 1.5; the number of a node'; ...
  changed(dofs, 5, 1, 2), 'dofs has node 2, component 1 in row 2 and in row 5'};
for k = 1:size(messages, 1)
  raised = raised_by(@() nlmodes.structure(K, M, 'dofs', messages{k, 1}));
  expect(~isempty(strfind(raised.message, messages{k, 2})), raised.message);
end
end

function matrix = changed(matrix, row, column, value)
matrix(row, column) = value;
end

function curves_are_drawn_by_their_stability(~)
columns = struct('energy_j', (1:8)', 'frequency_hz', (11:18)', 'stable', [1; 1; 0; 0; NaN; 1; 1; 1]);
columns.event = {'grazing'; ''; 'fold kink'; ''; ''; 'tongue-foot'; 'resumed'; ''};
result = struct('folder', 'x', 'branches', struct('name', 'one', 'branch', columns));
lines = drawn(@() nlmodes.plot(result));
if isempty(lines), return; end
solid = lines_with(lines, 'displayname', 'one');
same('stable', solid.xdata, [NaN, 1:3, NaN, 7:8, NaN]);
dashed = lines_with(lines, 'handlevisibility', 'off', 'linestyle', '--');
same('unstable', dashed.xdata, [NaN, 3:5, NaN]);
thin = lines_with(lines, 'handlevisibility', 'off', 'linestyle', '-');
same('unknown', thin.ydata, [NaN, 15:16, NaN]);
expect(thin.linewidth < solid.linewidth, 'what is unknown is not thinner');
same('fold', lines_with(lines, 'displayname', 'fold').xdata, 3);
markers = arrayfun(@(name) lines_with(lines, 'displayname', name{1}).marker, ...
  {'grazing', 'fold', 'kink', 'tongue foot', 'resumed'}, 'UniformOutput', false);
same('markers', numel(unique(markers)), 5);
same('keys', numel([lines_with(lines, 'displayname', 'unstable'), ...
  lines_with(lines, 'displayname', 'stability unknown')]), 2);
levels = struct('level', [1; 1] / 3, 'curve', [0; 0], 'name', {{'0.3333333333333333 N'; '0.3333333333333333 N'}});
curves = nlmodes.internal.curves(struct('branches', struct('name', '', 'branch', levels)));
same('name', curves.name, '0.3333 N');
same('label', nlmodes.internal.label('approach_velocity_m_s'), 'approach velocity in m/s');
end

function tests_are_drawn_over_curves(root)
test = nlmodes.extract(scene_of(root, 'measured_record'), 'out', 'drawn', 'quiet', true);
columns = struct('energy_j', [1; 2], 'frequency_hz', [42; 43], 'modal_amplitude', [1; 2] * 1e-4, 'event', {{''; ''}});
computed = struct('folder', 'x', 'branches', struct('name', 'computed', 'branch', columns));
lines = drawn(@() nlmodes.plot(computed, 'over', test));
if isempty(lines), return; end
points = lines_with(lines, 'marker', 'o');
same('abscissa', points.xdata, test.points.modal_amplitude');
same('ordinate', points.ydata, test.points.frequency_hz');
same('curve', lines_with(lines, 'displayname', 'computed').xdata, [NaN, 1e-4, 2e-4, NaN]);
% Bars: one standard error to both sides.
lines = drawn(@() nlmodes.plot(test));
bars = lines_with(lines, 'handlevisibility', 'off');
bars = {bars.ydata};
[f, df] = deal(test.points.frequency_hz(1), test.points.frequency_hz_uncertainty(1));
expect(any(cellfun(@(bar) isequal(bar(1:2), [f - df, f + df]), bars)), 'no bar has the standard error');
own = struct('modal_amplitude', 1, 'frequency_hz', 2);
same('own table', numel(lines_with(drawn(@() nlmodes.plot(computed, 'over', own)), 'displayname', 'test')), 1);
end

function lines = drawn(call)
% The lines of a figure that is not shown; none where there is nothing to draw with.
lines = [];
if exist('OCTAVE_VERSION', 'builtin') && isempty(available_graphics_toolkits()), return; end
before = warning('off', 'all');
back = onCleanup(@() warning(before));
own = figure('visible', 'off');
gone = onCleanup(@() close(own));
call();
lines = findall(gca, 'type', 'line');
kept = {'displayname', 'handlevisibility', 'linestyle', 'linewidth', 'marker', 'xdata', 'ydata'};
lines = arrayfun(@(one) cell2struct(get(one, kept)', kept), lines, 'UniformOutput', false);
lines = [lines{:}];
end

function lines = lines_with(lines, varargin)
for k = 1:2:numel(varargin)
  lines = lines(strcmp({lines.(varargin{k})}, varargin{k + 1}));
end
end

function nothing_is_left_in_the_temporary_folder(root)
if ~exist('OCTAVE_VERSION', 'builtin') || ispc, return; end
mkdir('temporary');
toolbox = fullfile(root, 'crates', 'nlmodes-cli', 'matlab');
write('session.m', sprintf(['addpath(''%s'');\nscene = nlmodes.structure([2, -1; -1, 2], eye(2));\n', ...
  'scene.contact = struct(''node'', 1, ''normal'', [1, 0, 0], ''gap_m'', 1e-3);\nscene.reduction.modes = 1;\n', ...
  'scene.method.harmonics = 3;\nresult = nlmodes.run(scene, ''quiet'', true);\nclear all\n', ...
  'fprintf(''%%d\\n'', numel(dir(tempdir)) - 2);\n'], toolbox));
octave = fullfile(OCTAVE_HOME(), 'bin', 'octave-cli');
[status, said] = system(sprintf('TMPDIR="%s" NLMODES_CLI="%s" "%s" --no-init-file --quiet session.m 2>&1', ...
  fullfile(pwd, 'temporary'), nlmodes.program(), octave));
expect(status == 0 && ~isempty(regexp(said, '(^|\n)1\n', 'once')), said);
same('left', numel(dir('temporary')) - 2, 0);
end

function scene = small_rod()
scene.structure = struct('kind', 'rod', 'length_m', 1, 'elements', 8, 'start', 'clamped');
scene.structure.material = struct('youngs_modulus_gpa', 210, 'density_kg_m3', 7850);
scene.structure.section.area_m2 = 1e-4;
scene.contact = struct('at_m', 1, 'direction', 'axial', 'side', 'positive', 'gap_mm', 1);
scene.method.harmonics = 3;
scene.continuation.max_energy_ratio = 3;
end

function removed(folder)
if exist('OCTAVE_VERSION', 'builtin'), confirm_recursive_rmdir(false, 'local'); end
rmdir(folder, 's');
end

function file = scene_of(root, name)
file = fullfile(root, 'configs', [name, '.toml']);
end

function folder = command_line_run(scene, options)
folder = tempname(pwd);
[status, said] = system(sprintf('"%s" run "%s" %s --quiet --out "%s" 2>&1', nlmodes.program(), scene, options, folder));
expect(status == 0, said);
end

function same_files(ours, theirs)
same_bytes(ours, theirs, {'branch.csv', 'contacts.csv', 'participation.csv', 'harmonics.npz', 'histories.npz'});
end

function same_bytes(ours, theirs, names)
for name = names
  expect(isequal(bytes_of(fullfile(ours, name{1})), bytes_of(fullfile(theirs, name{1}))), [name{1}, ' differs']);
end
end

function bytes = bytes_of(file)
in = nlmodes.internal.open(file, 'r');
bytes = fread(in, Inf, 'uint8=>uint8');
fclose(in);
end

function write(file, text)
out = nlmodes.internal.open(file, 'w');
fprintf(out, '%s', text);
fclose(out);
end

function same(what, found, expected)
if isnumeric(found) && isnumeric(expected)
  equal = isequal(size(found), size(expected)) && isequaln(double(found), double(expected));
else
  equal = isequaln(found, expected);
end
if ~equal
  error('nlmodes:test', '%s is %s, not %s', what, shown(found), shown(expected));
end
end

function text = shown(value)
text = [class(value), ' ', mat2str(size(value))];
if ischar(value), text = ['"', value, '"']; end
end

function expect(truth, said)
if ~truth, error('nlmodes:test', '%s', said); end
end

function raised = raised_by(call)
raised = [];
try
  call();
catch raised
end
expect(~isempty(raised), 'no error was raised');
end
