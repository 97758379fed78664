function text = toml_value(value, key)
%TOML_VALUE  A value as TOML: texts, numbers, truths, lists of them, lists of lists of a matrix, inline tables of
% structures.
if isscalar_value(value) && nlmodes.internal.is_list(key, value)
  text = ['[', nlmodes.internal.toml_value(value, ''), ']'];
elseif ischar(value) && size(value, 1) <= 1
  text = quoted(value);
elseif isa(value, 'string') && isscalar(value)
  text = quoted(char(value));
elseif isa(value, 'string')
  text = list_of(cellstr(value), key);
elseif iscell(value)
  text = list_of(value, key);
elseif isstruct(value) && isscalar(value)
  text = table_of(value, key);
elseif isstruct(value)
  text = list_of(num2cell(value), key);
elseif islogical(value) && isscalar(value)
  names = {'false', 'true'};
  text = names{1 + value};
elseif (isnumeric(value) || islogical(value)) && isreal(value)
  text = numbers(value, key);
elseif isnumeric(value)
  error('nlmodes:scene', '`%s` is complex; real numbers were expected: amplitude_n and phase_deg of a force', key);
else
  error('nlmodes:scene', '`%s` is a %s; a text, a number, a list or a structure was expected', key, class(value));
end
end

function yes = isscalar_value(value)
yes = (ischar(value) && size(value, 1) <= 1) || (isscalar(value) && ~iscell(value));
end

function text = numbers(value, key)
matrices = {'contact_rows', 'flexibility_m_n', 'residual_flexibility_m_n', 'rows', 'shapes'};
if isempty(value)
  text = '[]';
elseif any(strcmp(regexprep(key, '^.*\.', ''), matrices)) && ndims(value) == 2 %#ok<ISMAT> of one row or column too
  row_of = @(k) ['[', strjoin(arrayfun(@(one) number(double(one)), value(k, :), 'UniformOutput', false), ', '), ']'];
  text = ['[', strjoin(arrayfun(row_of, 1:size(value, 1), 'UniformOutput', false), ', '), ']'];
elseif isscalar(value)
  text = number(double(value));
elseif ndims(value) == 2 && any(size(value) == 1) %#ok<ISMAT> vectors of both orientations are lists
  text = list_of(num2cell(value), key);
elseif ndims(value) == 2 %#ok<ISMAT>
  text = list_of(arrayfun(@(row) value(row, :), 1:size(value, 1), 'UniformOutput', false), key);
else
  error('nlmodes:scene', '`%s` has %d dimensions; at most 2 were expected', key, ndims(value));
end
end

function text = number(value)
% Whole numbers are written as such; they serve as real numbers too. Others with the fewest digits that give them back.
if ~isfinite(value)
  text = lower(num2str(value));
elseif value == fix(value) && abs(value) < 2 ^ 53
  text = sprintf('%d', value);
else
  for digits = [15, 16, 17]
    text = sprintf('%.*g', digits, value);
    if str2double(text) == value, break; end
  end
end
end

function text = list_of(values, key)
parts = cellfun(@(one) nlmodes.internal.toml_value(one, ''), values(:)', 'UniformOutput', false);
text = ['[', strjoin(parts, ', '), ']'];
end

function text = table_of(value, key)
names = fieldnames(value)';
parts = cell(1, 0);
for k = 1:numel(names)
  if isequal(value.(names{k}), []), continue; end
  parts{end + 1} = [names{k}, ' = ', nlmodes.internal.toml_value(value.(names{k}), [key, '.', names{k}])]; %#ok<AGROW>
end
text = ['{ ', strjoin(parts, ', '), ' }'];
end

function text = quoted(value)
text = strrep(strrep(value, '\', '\\'), '"', '\"');
text = strrep(strrep(strrep(text, char(10), '\n'), char(13), '\r'), char(9), '\t');
text = ['"', text, '"'];
end
