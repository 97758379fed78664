% A steel cantilever whose tip meets a rigid stop: its nonlinear mode, and how it answers to a shaker.
%
% 0.63 m long, 12 mm x 20 mm, 1 mm from the stop: frequency over energy of the first mode, and the responses at three
% levels of force.
scene = struct('title', 'Cantilever before a stop');
scene.structure = struct('kind', 'beam', 'length_m', 0.63, 'elements', 20, 'start', 'clamped', 'end', 'free');
scene.structure.material = struct('youngs_modulus_gpa', 210, 'density_kg_m3', 7850, 'poissons_ratio', 0.3);
scene.structure.section = struct('width_mm', 12, 'height_mm', 20);
scene.contact = struct('at_m', 0.63, 'direction', 'transverse', 'side', 'positive', 'gap_mm', 1.0);
scene.method = struct('mode', 1, 'harmonics', 7);

% The nonlinear mode: from the motion that just touches to six times its energy.
mode = nlmodes.run(scene, 'continuation.max_energy_ratio', 6);
fprintf('grazing at %.4f Hz, %.4f Hz at six times the energy\n', mode.branch.frequency_hz([1, end]));

% Responses near the mode: 0.2 % of damping, a harmonic force at 73 mm from the clamp.
scene.damping.ratio_percent = 0.2;
scene.force = struct('at_m', 0.073, 'direction', 'transverse');
scene.response = struct('kind', 'frequency', 'frequency_hz', [41, 45], 'levels_n', [0.5, 2, 5]);
driven = nlmodes.run(scene);

figure(1); clf
nlmodes.plot(mode);
figure(2); clf
nlmodes.plot(driven);
