function value = optional(reader, file, wanted)
%OPTIONAL  What the reader finds in a file; [] where there is none, or it is not wanted.
value = [];
if wanted && isfile(file), value = reader(file); end
end
