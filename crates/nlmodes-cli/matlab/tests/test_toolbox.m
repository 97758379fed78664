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
  @the_plot_names_missing_columns};
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
fprintf('%d of %d passed\n', numel(tests) - failed, numel(tests));
if failed > 0, error('nlmodes:test', '%d tests failed', failed); end
end

function numbers_are_those_of_the_binary_file(root)
% The same numbers twice: as texts of the tables and NumPy arrays, read here, and as doubles in results.mat, read by the
% language itself.
result = nlmodes.run(scene_of(root, 'beam_responses'), 'out', 'responses', 'output.matlab', true, ...
  'response.0.levels_n', [5, 20]);
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
result = nlmodes.run(scene_of(root, 'rod'), 'out', 'ours', 'method.harmonics', 5);
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
result = nlmodes.run(scene);
same_files(result.folder, command_line_run('by_hand.toml', ''));
expect(numel(result.branch.point) > 5, 'hardly a branch');
end

function parts_are_in_the_order_of_the_summary(root)
result = nlmodes.run(scene_of(root, 'rod'), 'out', 'parts', 'method.harmonics', [3, 1]);
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
raised = raised_by(@() nlmodes.run('wrong.toml'));
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
result = nlmodes.run(scene);
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
law = struct('polynomial', [0, 0, 6e9]);
same('value', nlmodes.internal.toml_value(law, 'law'), '{ polynomial = [0, 0, 6000000000] }');
end

function paths_are_those_of_the_current_folder(~)
write('here.txt', 'x');
scene = nlmodes.internal.with_absolute_paths(struct('a', struct('mass', 'here.txt#M'), 'kind', 'rod', 'b', 'not.here'));
same('path', scene.a.mass, [fullfile(pwd, 'here.txt'), '#M']);
same('texts', {scene.kind, scene.b}, {'rod', 'not.here'});
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

function file = scene_of(root, name)
file = fullfile(root, 'configs', [name, '.toml']);
end

function folder = command_line_run(scene, options)
folder = tempname;
[status, said] = system(sprintf('"%s" run "%s" %s --quiet --out "%s" 2>&1', nlmodes.program(), scene, options, folder));
expect(status == 0, said);
end

function same_files(ours, theirs)
% Tables and arrays, byte by byte.
for name = {'branch.csv', 'contacts.csv', 'participation.csv', 'harmonics.npz', 'histories.npz'}
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
