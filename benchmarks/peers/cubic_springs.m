function cubic_springs(nlvib, folder)
% NLvib's examples with cubic springs, and its own residual at points of other curves (see cubic_springs.py): writes the
% matrices of the systems, reads `points.mat`, and writes `answer.json` with the largest relative differences.
addpath(fullfile(nlvib, 'SRC'), fullfile(nlvib, 'SRC', 'MechanicalSystems'));
c = load(fullfile(folder, 'case.mat'));
[sys, H, begins, ends, ds, is_free, scales, inorm, x0, fscl] = example(c.name);
N = 4 * H + 1;
if is_free
  residual = @(X) HB_residual(X, sys, H, N, 'NMA', inorm, fscl);
else
  residual = @(X) HB_residual(X, sys, H, N, 'FRF');
end
if ~isfield(c, 'points')
  M = sys.M; K = sys.K;
  save('-v7', fullfile(folder, 'system.mat'), 'M', 'K');
  return
end
% Each point by Newton's method across the curve: the shortest way onto that of NLvib.
differences = zeros(1, size(c.points, 2));
for k = 1:size(c.points, 2)
  X = c.points(:, k);
  D = max(abs(X)) * ones(size(X));
  D(numel(x0) - is_free:end) = max(abs(X(numel(x0) - is_free:end)), 1e-3);
  for i = 1:20
    [R, dR] = residual(X);
    step = D .* ((dR .* D') \ R);
    X = X - step;
    if norm(step ./ D) <= 1e-13, break; end
  end
  differences(k) = norm((X - c.points(:, k)) ./ D) / norm(X ./ D);
end
% The options of NLvib for fsolve; its own call, optimset(@fsolve), is for MATLAB only.
start = cputime();
solver = optimset('Display', 'off', 'Jacobian', 'on', 'MaxIter', 50, 'TolFun', 1e-10, 'TolX', 1e-10);
[X, ~] = solve_and_continue(x0, residual, begins, ends, ds, scales, {}, solver);
answer = struct('differences', differences, 'cpu_s', cputime() - start, 'points', size(X, 2), 'last', X(end, end));
file = fopen(fullfile(folder, 'answer.json'), 'w');
fprintf(file, '%s', jsonencode(answer));
fclose(file);
end

function [sys, H, begins, ends, ds, is_free, options, inorm, x0, fscl] = example(name)
is_free = any(strcmp(name, {'04', '06', '09'}));
inorm = 0; fscl = 1;
switch name
  case '01'
    sys = ChainOfOscillators([1], [.05 0], [1 0], {struct('type', 'cubicSpring', 'stiffness', .1, ...
      'force_direction', 1)}, .18);
    [H, begins, ends, ds] = deal(7, .5, 1.6, .01);
  case '02'
    sys = ChainOfOscillators([1 .05], [.002 .013 0], [1 .0453 0], {struct('type', 'cubicSpring', 'stiffness', 1, ...
      'force_direction', [1; 0]), struct('type', 'cubicSpring', 'stiffness', .0042, 'force_direction', [1; -1])}, ...
      [.11; 0]);
    [H, begins, ends, ds] = deal(7, .8, 1.4, .02);
  case '04'
    sys = ChainOfOscillators([1 1], [0 0 0], [1 1 1], struct('type', 'cubicSpring', 'stiffness', .5, ...
      'force_direction', [1; 0]));
    [H, begins, ends, ds, inorm] = deal(9, -1, c_end(), .013, 2);
  case {'06', '06, forced'}
    s = [1.13 2] .^ 2;
    sys = System_with_PolynomialStiffnessNonlinearity(eye(2), diag([2e-3 * 1.13, 1e-2 * 2]), diag(s), ...
      [2 0; 1 1; 0 2; 3 0; 2 1; 1 2; 0 3], ...
      [1.5 * s(1), s(2) / 2; s(2), s(1); s(1) / 2, 1.5 * s(2); sum(s) / 2 * [1 0; 0 1; 1 0; 0 1]], 3e-3 * [1; 1]);
    [H, begins, ends, ds] = deal(7, 1.6, .8, .005);
    if is_free
      [begins, ends, ds, inorm] = deal(-6, -.5, .01, 1);
    end
  case '09'
    sys = FE_EulerBernoulliBeam(.7, .014, .014, 2.05e11, 7800, 'clamped-free', 20);
    add_nonlinear_attachment(sys, 20, 'trans', 'cubicSpring', 'stiffness', 6e9);
    [H, begins, ends, ds, inorm] = deal(5, -5, -3, .6, sys.n - 1);
end
n = sys.n;
if is_free
  [phi, squares] = eig(full(sys.K), full(sys.M));
  [om, order] = sort(sqrt(diag(squares)));
  om = om(1); phi = phi(:, order(1));
  Psi = zeros((2 * H + 1) * n, 1);
  Psi(n + (1:n)) = phi;
  x0 = [Psi; om; 0];
  if strcmp(name, '09')
    fscl = mean(abs(sys.K * phi));
    options = struct('Dscale', [max(abs(Psi)) * 1e-2 * ones(numel(Psi), 1); om; 1; 1], 'dynamicDscale', 1);
  else
    options = struct('Dscale', [1e-1 * ones(numel(Psi), 1); 1; 1e-8; 1], 'dynamicDscale', 1);
  end
else
  Q1 = (-begins ^ 2 * sys.M + 1i * begins * sys.D + sys.K) \ sys.Fex1;
  x0 = zeros((2 * H + 1) * n, 1);
  x0(n + (1:2 * n)) = [real(Q1); -imag(Q1)];
  options = struct('Dscale', [ones(numel(x0), 1); begins]);
end
end

function e = c_end()
e = 0.3;
end
