function words = set_options(overrides)
%SET_OPTIONS  Words of the command line that replace values of a scene, of {key, value} rows.
words = cell(1, 0);
for k = 1:size(overrides, 1)
  value = nlmodes.internal.toml_value(overrides{k, 2}, overrides{k, 1});
  words = [words, {'--set', [overrides{k, 1}, '=', value]}]; %#ok<AGROW>
end
end
