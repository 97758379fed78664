function array = npy(file)
%NPY  An array of NumPy (format 1 to 3, little-endian): real, complex, whole numbers, truths and texts.
in = nlmodes.internal.open(file, 'r');
done = onCleanup(@() fclose(in));
magic = fread(in, 8, 'uint8')';
if ~isequal(magic(1:6), [147, double('NUMPY')])
  error('nlmodes:run', '%s is no array of NumPy', file);
end
widths = {'uint16', 'uint32'};
length = fread(in, 1, widths{1 + (magic(7) > 1)}, 0, 'ieee-le');
header = char(fread(in, length, 'uint8')');
type = regexp(header, '''descr'': *''([^'']*)''', 'tokens', 'once');
shape = regexp(header, '''shape'': *\(([^)]*)\)', 'tokens', 'once');
fortran = ~isempty(regexp(header, '''fortran_order'': *True', 'once'));
array = shaped(values_of(in, type{1}, file), str2double(regexp(shape{1}, '\d+', 'match')), fortran);
end

function values = values_of(in, type, file)
count = str2double(type(3:end));
switch type(2)
  case 'f', values = fread(in, Inf, sprintf('float%d=>double', 8 * count), 0, 'ieee-le');
  case 'i', values = fread(in, Inf, sprintf('int%d=>double', 8 * count), 0, 'ieee-le');
  case 'u', values = fread(in, Inf, sprintf('uint%d=>double', 8 * count), 0, 'ieee-le');
  case 'b', values = fread(in, Inf, 'uint8=>double', 0, 'ieee-le') ~= 0;
  case 'c'
    parts = reshape(fread(in, Inf, sprintf('float%d=>double', 4 * count), 0, 'ieee-le'), 2, []);
    values = complex(parts(1, :), parts(2, :)).';
  case 'U'
    codes = reshape(fread(in, Inf, 'uint32=>double', 0, 'ieee-le'), count, []);
    values = arrayfun(@(k) char(codes(codes(:, k) ~= 0, k)'), (1:size(codes, 2))', 'UniformOutput', false);
  otherwise
    error('nlmodes:run', '%s has the type %s, which is not read here', file, type);
end
end

function array = shaped(values, shape, fortran)
if numel(shape) < 2
  array = values(:);
elseif fortran
  array = reshape(values, shape);
else
  array = permute(reshape(values, fliplr(shape)), numel(shape):-1:1);
end
end
