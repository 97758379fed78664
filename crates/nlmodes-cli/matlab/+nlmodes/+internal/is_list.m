function yes = is_list(name, value)
%IS_LIST  Whether a key holds a list even if there is one value only, for which MATLAB has no type of its own.
%
% Lists of numbers or texts have names in the plural; lists of tables are those that may occur several times in a scene.
name = regexprep(name, '^.*\.', '');
if isstruct(value)
  yes = any(strcmp(name, {'contact', 'force', 'static_force', 'spring', 'channel', 'segment', ...
    'sensitivity', 'vary', 'quantity', 'mass_point', 'dashpot', 'load', 'place', 'sensor', 'overlay'}));
elseif ischar(value) || isa(value, 'string')
  yes = any(strcmp(name, {'files', 'fixed', 'methods', 'parameters'}));
else
  yes = ~isempty(regexp(name, '^(levels|positions|accelerometers|(damping_)?ratios|frequencies)(_|$)', 'once')) ...
    || any(strcmp(name, {'fixed', 'histories', 'nodes', 'polynomial', 'values'}));
end
end
