function nlvib_case(nlvib, file, out)
% One case by NLvib: reads `file` (written by nlvib.py), writes the values as JSON. NLvib's own functions compute; the
% last point is refined here by
% Newton's method on NLvib's residual with the condition that the case adds.
addpath(fullfile(nlvib, 'SRC'), fullfile(nlvib, 'SRC', 'MechanicalSystems'));
c = load(file);
elements = cell(1, numel(c.gaps));
for j = 1:numel(c.gaps)
  elements{j} = struct('type', 'unilateralSpring', 'stiffness', c.stiffnesses(j), 'gap', c.gaps(j), ...
    'force_direction', c.directions(:, j));
end
sys = MechanicalSystem(c.M, c.C, c.K, elements, c.force(:));
n = sys.n;
H = double(c.harmonics);
N = 2 ^ nextpow2(double(c.samples) * H);
start = cputime();
if c.is_free
  answer = free_motion(sys, c, n, H, N);
else
  answer = response(sys, c, n, H, N);
end
answer.cpu_s = cputime() - start;
file = fopen(out, 'w');
fprintf(file, '%s', jsonencode(answer));
fclose(file);
end

function answer = free_motion(sys, c, n, H, N)
% Nonlinear modal analysis from just below grazing; the branch is followed over the logarithm of the modal amplitude
% until its energy is passed.
residual = @(X) HB_residual(X, sys, H, N, 'NMA', double(c.ref));
phi = c.shape(:) / sqrt(c.shape(:)' * sys.M * c.shape(:));
Psi = zeros((2 * H + 1) * n, 1);
Psi(n + (1:n)) = phi;
first = log10(0.9 * sqrt(c.grazing_energy * 4) / c.omega);
last = log10(3 * sqrt(c.energy * 4) / c.omega);
scales = [1e-1 * ones(numel(Psi), 1); c.omega; 1e-6 + 1e-2 * any(c.C(:)); 1];
passed = @(X) kinetic(X, sys, n, H) > c.energy;
options = struct('Dscale', scales, 'dynamicDscale', 1, 'stepmax', 600, 'stoponerror', 1, 'dsmin', 1e-6);
options.termination_criterion = {passed};
[X, ~] = solve_and_continue([Psi; c.omega; 0], residual, first, last, double(c.ds), options, {}, solver());
x = X(:, end);
condition = @(X) kinetic(X, sys, n, H) / c.energy - 1;
x = refined(residual, condition, x);
answer = struct('frequency', x(end - 2), 'damping_ratio', x(end - 1));
answer.impulses = impulses(x(1:end - 3) * 10 ^ x(end), x(end - 2), c, n, H);
end

function answer = response(sys, c, n, H, N)
% Frequency response from one end of the window; each passage of the frequency is refined, and that nearest to the
% amplitude is the answer.
residual = @(X) HB_residual(X, sys, H, N, 'FRF');
Q1 = (-c.begins ^ 2 * sys.M + 1i * c.begins * sys.D + sys.K) \ sys.Fex1;
y0 = zeros((2 * H + 1) * n, 1);
y0(n + (1:2 * n)) = [real(Q1); -imag(Q1)];
options = struct('Dscale', [ones(size(y0)); c.begins], 'stepmax', 1500, 'dsmin', double(c.ds) / 500);
[X, ~] = solve_and_continue(y0, residual, c.begins, c.ends, double(c.ds), options, {}, solver());
size_of = @(x) hypot(x(n + c.drive), x(2 * n + c.drive));
w = X(end, :);
if c.asks_fold
  turns = find(diff(w(1:end - 1)) .* diff(w(2:end)) < 0) + 1;
  [~, k] = min(abs(w(turns) - c.near));
  answer = struct('frequency', parabola(w, turns(k)));
  return
end
if c.asks_lag
  % The driven mass lags by 90 degrees where its cosine vanishes.
  value = X(n + c.drive, :);
  at = find(value(1:end - 1) .* value(2:end) < 0);
  [~, k] = max(arrayfun(@(i) size_of(X(:, i)), at));
  x = refined(residual, @(X) X(n + c.drive), X(:, at(k)));
  answer = struct('frequency', x(end), 'amplitude', size_of(x));
  return
end
at = find((w(1:end - 1) - c.omega) .* (w(2:end) - c.omega) <= 0);
best = Inf;
answer = struct();
for k = at
  s = (c.omega - w(k)) / (w(k + 1) - w(k));
  x = refined(residual, @(X) X(end) - c.omega, X(:, k) + s * (X(:, k + 1) - X(:, k)));
  distance = abs(log(size_of(x) / c.near));
  if distance < best
    best = distance;
    answer = struct('amplitude', size_of(x), 'impulses', impulses(x(1:end - 1), c.omega, c, n, H));
  end
end
end

function options = solver()
% The options of NLvib for fsolve; its own call, optimset(@fsolve), is for MATLAB only.
options = optimset('Display', 'off', 'Jacobian', 'on', 'MaxIter', 50, 'TolFun', 1e-10, 'TolX', 1e-10);
end

function x = refined(residual, condition, x)
% Newton's method for the residual and one more condition, whose derivative is a difference.
for step = 1:30
  [r, J] = residual(x);
  g = condition(x);
  if norm([r; g]) < 1e-12, break; end
  row = zeros(1, numel(x));
  for i = 1:numel(x)
    h = 1e-7 * max(1, abs(x(i)));
    moved = x;
    moved(i) = moved(i) + h;
    row(i) = (condition(moved) - g) / h;
  end
  x = x - [J; row] \ [r; g];
end
if ~(norm([r; g]) < 1e-8), error('no convergence at the last point'); end
end

function w = parabola(w, k)
% Extremum of the parabola through three points by number.
y = w(k - 1:k + 1);
d = (y(3) - y(1)) / 2;
w = y(2) - d ^ 2 / (2 * (y(3) - 2 * y(2) + y(1)));
end

function energy = kinetic(X, sys, n, H)
Q = reshape(X(1:end - 3) * 10 ^ X(end), n, 2 * H + 1);
energy = 0;
for h = 1:H
  part = Q(:, 2 * h:2 * h + 1);
  energy = energy + 0.25 * (h * X(end - 2)) ^ 2 * sum(sum(part .* (sys.M * part)));
end
end

function values = impulses(Q, omega, c, n, H)
Q = reshape(Q, n, 2 * H + 1);
tau = 2 * pi * (0:16383) / 16384;
values = zeros(1, numel(c.gaps));
for j = 1:numel(c.gaps)
  u = c.directions(:, j)' * Q;
  motion = u(1) * ones(size(tau));
  for h = 1:H
    motion = motion + u(2 * h) * cos(h * tau) + u(2 * h + 1) * sin(h * tau);
  end
  values(j) = c.stiffnesses(j) * mean(max(motion - c.gaps(j), 0)) * 2 * pi / omega;
end
end
