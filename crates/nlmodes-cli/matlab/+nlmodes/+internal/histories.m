function curves = histories(motion, x, y)
%HISTORIES  Two arrays of a motion in time as curves for figures, one for each place or contact.
rows = motion.(y);
if size(rows, 2) ~= numel(motion.(x))
  error('nlmodes:run', '%s has %d columns, not one for each of the %d values of %s', y, size(rows, 2), ...
    numel(motion.(x)), x);
end
% Contacts are behind the places, and forces are theirs alone.
names = motion.place(end - size(rows, 1) + 1:end);
curves = struct('name', {}, 'columns', {}, 'is_test', {});
for k = 1:size(rows, 1)
  columns = struct(x, motion.(x)(:), y, rows(k, :)');
  curves(k) = struct('name', names{k}, 'columns', columns, 'is_test', false);
end
end
