function text = toml(scene)
%TOML  A scene of nested structures as the text of a TOML file.
%
% Fields that are [] are left out, as those of structure arrays that only other elements have.
text = tables('', scene);
end

function text = tables(path, value)
names = fieldnames(value)';
deeper = cellfun(@(name) is_tables(value.(name)), names);
text = '';
for name = names(~deeper)
  if isequal(value.(name{1}), []), continue; end
  own = nlmodes.internal.toml_value(value.(name{1}), [path, name{1}]);
  text = [text, sprintf('%s = %s\n', name{1}, own)]; %#ok<AGROW>
end
for name = names(deeper)
  text = [text, nested([path, name{1}], value.(name{1}))]; %#ok<AGROW>
end
end

function text = nested(path, value)
several = iscell(value) || numel(value) ~= 1 || nlmodes.internal.is_list(path, value);
if ~iscell(value), value = num2cell(value); end
marks = {'[', ']'; '[[', ']]'};
text = '';
for k = 1:numel(value)
  head = sprintf('\n%s%s%s\n', marks{1 + several, 1}, path, marks{1 + several, 2});
  text = [text, head, tables([path, '.'], value{k})]; %#ok<AGROW>
end
end

function yes = is_tables(value)
one_table = @(one) isstruct(one) && isscalar(one);
yes = isstruct(value) || (iscell(value) && ~isempty(value) && all(cellfun(one_table, value)));
end
