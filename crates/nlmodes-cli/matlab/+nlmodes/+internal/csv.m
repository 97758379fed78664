function table = csv(file)
%CSV  A table as a structure with a column vector for each column.
%
% Numbers are read to the last bit, truths are 1 and 0, unknown ones (empty fields) NaN; a column that has other texts
% is a cell array.
lines = strsplit(strtrim(nlmodes.internal.text_of(file)), char(10));
names = fields_of(lines{1});
cells = cell(numel(lines) - 1, numel(names));
for k = 2:numel(lines)
  cells(k - 1, :) = fields_of(lines{k});
end
table = struct();
for k = 1:numel(names)
  table.(matlab_name(names{k})) = column_of(names{k}, cells(:, k));
end
end

function fields = fields_of(line)
% Fields between commas; those with a comma are written between quotes, in which a quote is doubled.
line(line == 13) = [];
if ~any(line == '"')
  fields = strsplit(line, ',', 'CollapseDelimiters', false);
  return
end
inside = mod(cumsum(line == '"'), 2) == 1;
ends = [find(line == ',' & ~inside), numel(line) + 1];
starts = [1, ends(1:end - 1) + 1];
fields = arrayfun(@(a, b) unquoted(line(a:b - 1)), starts, ends, 'UniformOutput', false);
end

function text = unquoted(text)
if numel(text) > 1 && text(1) == '"'
  text = strrep(text(2:end - 1), '""', '"');
end
end

function column = column_of(name, cells)
% Truths become 1 and 0, so that they can be unknown too.
texts = {'event', 'resonance', 'kind', 'name', 'findings', 'record'};
column = str2double(cells);
column(strcmp(cells, 'true')) = 1;
column(strcmp(cells, 'false')) = 0;
wrong = ~cellfun('isempty', cells) & isnan(column) & ~strcmpi(cells, 'nan');
if any(strcmp(name, texts)) || any(wrong)
  column = cells;
end
end

function name = matlab_name(name)
name = regexprep(name, '[^A-Za-z0-9_]', '_');
if isempty(regexp(name, '^[A-Za-z]', 'once')), name = ['x_', name]; end
end
