/* Control of a vibration test in phase resonance, sample by sample: the C interface of the Rust crate nlmodes-loop.
 *
 * Written by cbindgen from the sources of the crate; do not edit.
 *
 * A program fills in the settings, makes a test of them, and calls nlmodes_loop_step once a sample:
 *
 *     nlmodes_loop_default_settings(&settings, ...);  settings.levels[0] = ...;
 *     nlmodes_loop_prepare(&settings, &loop);         outside of the real-time task
 *     nlmodes_loop_start(&loop, &state);
 *     each sample:  nlmodes_loop_step(&loop, &state, &input, &output);
 *
 * Memory is the caller's: nothing is allocated, and there is no state but that in these structures. Pointers may be
 * null, and are then refused; one that is not must point to a structure of that type that nobody else changes during
 * the call, and that has been filled in unless the function fills it in itself. What is in nlmodes_loop and
 * nlmodes_loop_state is the library's: copy it as a whole, read it, but do not write to single fields.
 */

#ifndef NLMODES_LOOP_H
#define NLMODES_LOOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
  double re;
  double im;
} nlmodes_complex;

// Length of the array that `nlmodes_loop_step_flat` writes.
#define nlmodes_FLAT_LENGTH 12

// Most harmonics that the adaptive detector can follow: a fixed number keeps its state free of allocation.
#define nlmodes_MAX_HARMONICS 8

// Most motion sensors of the control of harmonics.
#define nlmodes_MAX_SENSORS 32

// Most linear modes that they tell apart.
#define nlmodes_MAX_MODES 16

// Most levels of a schedule.
#define nlmodes_MAX_LEVELS 64

// Most windows that are considered together.
#define nlmodes_MAX_WINDOWS 16

// Why settings are refused.
typedef enum {
  // They are not.
  NLMODES_SETTINGS_REFUSAL_NONE,
  // A pointer is null.
  NLMODES_SETTINGS_REFUSAL_NULL_POINTER,
  // A number is not positive, is negative, or is not finite.
  NLMODES_SETTINGS_REFUSAL_NUMBER,
  // The start is not between the lowest and the highest frequency.
  NLMODES_SETTINGS_REFUSAL_FREQUENCY_RANGE,
  // The cut-off is too high for the frequency or the sampling.
  NLMODES_SETTINGS_REFUSAL_CUT_OFF,
  // Too many harmonics, sensors, modes or levels, or too few windows.
  NLMODES_SETTINGS_REFUSAL_COUNT,
  // A code has no meaning.
  NLMODES_SETTINGS_REFUSAL_CODE,
  // Numbers of sensors that do not fit, or no sensor at the drive point.
  NLMODES_SETTINGS_REFUSAL_SENSORS,
  // A harmonic of the force does not answer to the drive.
  NLMODES_SETTINGS_REFUSAL_NO_TRANSFER,
  // A harmonic is above half the sampling frequency.
  NLMODES_SETTINGS_REFUSAL_ABOVE_NYQUIST,
  // Unstable gains.
  NLMODES_SETTINGS_REFUSAL_UNSTABLE_GAINS,
  // A level is above the largest drive.
  NLMODES_SETTINGS_REFUSAL_ABOVE_LIMIT,
} nlmodes_SettingsRefusal;

// What the levels of a test are amplitudes of.
typedef enum {
  // The drive, N or V: no amplitude is controlled.
  NLMODES_CONTROLLED_DRIVE,
  // The fundamental of the measured force, N.
  NLMODES_CONTROLLED_FORCE,
  // The fundamental of the response, in its unit: stepped response.
  NLMODES_CONTROLLED_RESPONSE,
} nlmodes_Controlled;

// What the response sensor of the loop measures.
typedef enum {
  // m. Least distorted by higher harmonics, and so the choice of the paper (Section 4).
  NLMODES_RESPONSE_QUANTITY_DISPLACEMENT,
  // m/s.
  NLMODES_RESPONSE_QUANTITY_VELOCITY,
  // m/s².
  NLMODES_RESPONSE_QUANTITY_ACCELERATION,
} nlmodes_ResponseQuantity;

// What a test does at present.
typedef enum {
  // On the way to a level.
  NLMODES_STAGE_RAMP,
  // At the first level with frozen frequency.
  NLMODES_STAGE_START,
  // At a level, until it is steady.
  NLMODES_STAGE_SETTLE,
  // At a level that is to be recorded.
  NLMODES_STAGE_RECORD,
  // On the way to zero after the last level.
  NLMODES_STAGE_DOWN,
  // At zero after the last level.
  NLMODES_STAGE_FINISHED,
  // On the way to zero in an emergency.
  NLMODES_STAGE_STOPPING,
  // At zero after an emergency.
  NLMODES_STAGE_STOPPED,
} nlmodes_Stage;

// Why a test was ended.
typedef enum {
  // It was not.
  NLMODES_EMERGENCY_REASON_NONE,
  // The operator wanted it.
  NLMODES_EMERGENCY_REASON_OPERATOR,
  // The displacement exceeded its limit.
  NLMODES_EMERGENCY_REASON_STROKE,
  // The contact force exceeded its limit.
  NLMODES_EMERGENCY_REASON_CONTACT_FORCE,
  // The force of the exciter exceeded its limit.
  NLMODES_EMERGENCY_REASON_FORCE,
  // No finite samples for too long.
  NLMODES_EMERGENCY_REASON_SILENCE,
} nlmodes_EmergencyReason;

// The settings of a test for C: plain numbers, of which any is checked before it is used.
//
// `nlmodes_loop_default_settings` fills in all of them; set the levels and whatever else differs.
typedef struct {
  // Sampling interval, s.
  double step_s;
  // Rough angular eigenfrequency, for the gains and their limit, rad/s.
  double resonance_rad_s;
  // Rough damping ratio.
  double damping_ratio;
  // Angular frequency at the start, rad/s.
  double start_rad_s;
  // Lowest angular frequency, rad/s.
  double lowest_rad_s;
  // Highest angular frequency, rad/s.
  double highest_rad_s;
  // What the response sensor measures: 0 displacement, 1 velocity, 2 acceleration.
  uint32_t quantity;
  // 0: adaptive detector; 1, 2: demodulation with a low-pass of first, second order.
  uint32_t detector;
  // Harmonics of the adaptive detector, 1 to 8.
  uint32_t detector_harmonics;
  // What the levels are amplitudes of: 0 drive, 1 force, 2 response.
  uint32_t controlled;
  // Lag of the displacement behind the force to work for, rad.
  double lag_rad;
  // Cut-off of the detector, rad/s.
  double cut_off_rad_s;
  // Proportional gain, 1/s; with both gains zero they are designed.
  double proportional_1_s;
  // Integral gain, 1/s².
  double integral_1_s2;
  // Amplitude of the force below which it has no phase, N.
  double smallest_force_n;
  // Amplitude of the response below which it has no phase, in its unit.
  double smallest_response;
  // Largest lag error of the lock, rad.
  double lock_tolerance_rad;
  // Time for which it has to stay below, s.
  double lock_duration_s;
  // Rate of the control of an amplitude, 1/s.
  double amplitude_rate_1_s;
  // Proportional gain of the control of an amplitude: of a response the rate over the decay rate, of a force zero.
  double amplitude_gain;
  // Drive from which a controlled amplitude grows, N or V.
  double smallest_drive;
  // Levels, in the unit of what they are amplitudes of.
  double levels[nlmodes_MAX_LEVELS];
  // How many of them there are.
  uint32_t level_count;
  // Periods a window of the judgement whether a level is steady.
  uint32_t window_periods;
  // Number of windows, 3 to 16.
  uint32_t windows;
  // Harmonics of the force that are controlled; 1: the fundamental alone.
  uint32_t controlled_harmonics;
  // Time from level to level, s.
  double ramp_s;
  // Time at the first level with frozen frequency, s.
  double start_s;
  // Length of a record, s.
  double record_s;
  // Largest deviation of the mean lag, rad.
  double settled_lag_rad;
  // Largest relative drift of the frequency, 1/s.
  double settled_frequency_drift_1_s;
  // Largest relative drift of the response, 1/s.
  double settled_amplitude_drift_1_s;
  // Largest relative deviation of a controlled amplitude.
  double settled_amplitude;
  // Largest relative difference between single periods.
  double settled_spread;
  // Largest deviation of a controlled harmonic of the force over its fundamental.
  double settled_harmonics;
  // Standard errors of the noise that are let through beyond the first five.
  double settled_confidence;
  // Longest time at a level before it is recorded as it is, s.
  double longest_hold_s;
  // Largest peak of the drive, N or V; infinite: no limit, as for those below.
  double largest_drive;
  // Largest displacement, m.
  double largest_stroke_m;
  // Largest contact force, N.
  double largest_contact_force_n;
  // Largest force of the exciter, N.
  double largest_force_n;
  // Longest time without finite samples, s.
  double longest_silence_s;
  // Time in which the drive goes to zero in an emergency, s.
  double stop_duration_s;
  // Rate of the controlled harmonics, 1/s.
  double harmonics_rate_1_s;
  // Largest controlled harmonic of the force over its fundamental.
  double harmonics_largest;
  // Motion sensors of the control of harmonics.
  uint32_t sensor_count;
  // Linear modes that they tell apart.
  uint32_t mode_count;
  // Index of the sensor at the drive point.
  uint32_t drive_sensor;
  // What each sensor measures, as `quantity`.
  uint32_t sensor_quantities[nlmodes_MAX_SENSORS];
  // Pseudo-inverse of the mode shapes, a row a mode and a column a sensor, √kg.
  double modal_rows[nlmodes_MAX_MODES][nlmodes_MAX_SENSORS];
  // Angular eigenfrequency of each mode, rad/s.
  double mode_rad_s[nlmodes_MAX_MODES];
  // Damping ratio of each mode.
  double mode_damping_ratios[nlmodes_MAX_MODES];
  // Answer of the force to the drive in the harmonics 2, 3 …, N or N/V.
  nlmodes_complex transfer[nlmodes_MAX_HARMONICS];
} nlmodes_loop_settings;

// Gains of the loop filter: `ω = ω_start + K_p e + K_i ∫ e dt`.
typedef struct {
  // `K_p`, 1/s.
  double proportional;
  // `K_i`, 1/s².
  double integral;
} nlmodes_Gains;

// Sampled filter: `y = b₀ z + s₀`, and the states in transposed form.
typedef struct {
  double b[3];
  double a[2];
} nlmodes_SampledLowPass;

// A detector with its coefficients for one step.
typedef enum {
  NLMODES_PREPARED_DETECTOR_ADAPTIVE,
  NLMODES_PREPARED_DETECTOR_DEMODULATION,
} nlmodes_PreparedDetector_Tag;

typedef struct {
  uint32_t harmonics;
  double rate;
} nlmodes_PreparedDetector_nlmodes_Adaptive_Body;

typedef struct {
  nlmodes_PreparedDetector_Tag tag;
  union {
    nlmodes_PreparedDetector_nlmodes_Adaptive_Body ADAPTIVE;
    struct {
      nlmodes_SampledLowPass demodulation;
    };
  };
} nlmodes_PreparedDetector;

// When a loop counts as locked.
typedef struct {
  // Largest lag error, rad.
  double tolerance;
  // Time for which the error has to stay below it, s.
  double duration;
} nlmodes_LockSettings;

// What a step needs of the settings.
typedef struct {
  // Sampling interval, s.
  double step;
  double start;
  double range[2];
  nlmodes_Gains gains;
  nlmodes_PreparedDetector detector;
  // Lag of the measured response that the loop works for, rad.
  double target;
  double smallest[2];
  nlmodes_LockSettings lock;
} nlmodes_PreparedLoop;

// Control of an amplitude by that of the drive.
//
// ```text
// u̇ = max(u, u_0) (κ e + K ė) ,   e = 1 − |Y_1| / A* ,   −1 ≤ e ≤ 1
// ```
//
// Near the level `A*` the logarithm of the drive is under a proportional and an integral control, whatever the gain of
// the exciter; from zero, and wherever `e` is at its limit, the drive grows at the rate `κ`. A resonance of decay rate
// `δ` answers through `δ / (s + δ)`: with `K = κ/δ` the pole is cancelled, and the level is reached at the rate `κ`
// without overshoot. Against a stop the amplitude hardly depends on the drive, `ε = d ln|Y_1| / d ln u ≪ 1`, and the
// rest of a deviation decays at the rate `κ ε` only.
typedef struct {
  // What is controlled.
  nlmodes_Controlled controlled;
  // Rate `κ`, 1/s.
  double rate;
  // Proportional gain `K`.
  double gain;
  // Drive `u_0` from which the amplitude grows, N or V.
  double smallest;
} nlmodes_AmplitudeSettings;

// When a level is steady, judged on windows of whole periods against the noise that they show themselves.
//
// ```text
// y_k = ȳ + b t_k + r_k ,   s² = Σ r_k² / (n − 2)            a line through the means y_k of the last n windows
// |ȳ| ≤ tolerance + c s / √n                                 for the lag error and the controlled amplitude
// |b| ≤ tolerance + c s / √(Σ t_k²)                          for the drifts of frequency and response
// ```
//
// Single periods of a window must not differ by more than their own tolerance and `c` times what white noise of the
// sensors makes of them, and the means of controlled harmonics must have reached what is wanted.
//
// So a noisy sensor delays no level for ever, and a quiet one is held to the tolerances. What is not seen: a drift
// below `c` standard errors of its slope. The windows are taken to be independent; the control makes those of lag and
// frequency alternate, so that their errors are rather overestimated.
typedef struct {
  // Periods a window.
  size_t periods;
  // Number of windows `n`, from 3 to [`MAX_WINDOWS`].
  size_t windows;
  // Largest deviation of the lag from its target, rad.
  double lag;
  // Largest relative drift of the frequency, 1/s.
  double frequency_drift;
  // Largest relative drift of the response, 1/s.
  double amplitude_drift;
  // Largest relative deviation of a controlled amplitude from its level.
  double amplitude;
  // Largest root mean square difference of single periods from their mean, relative.
  double spread;
  // Largest deviation of a controlled harmonic of the force, relative to its fundamental.
  double harmonics;
  // Standard errors `c` that are let through beyond the first five tolerances.
  double confidence;
  // Longest time, s: after it the level is recorded as it is, and counts as not settled.
  double longest;
} nlmodes_SteadyCriteria;

// Levels of a test and their timing.
typedef struct {
  // Amplitudes in their order, in the unit of what is [controlled](crate::Controlled).
  double levels[nlmodes_MAX_LEVELS];
  // How many of them there are.
  size_t count;
  // Time from one level to the next, and to zero after the last, s.
  double ramp;
  // Time at the first level with frozen frequency, s, until response and detector have settled; zero: the frequency
  // is not frozen on the way there either.
  double start;
  // When a level is steady.
  nlmodes_SteadyCriteria settling;
  // Length of the record of each level, s.
  double record;
} nlmodes_LevelSchedule;

// What a test must not exceed. An infinite limit is none.
//
// The drive is kept below its limit. Any other excess is an emergency: the drive goes to zero within
// [`stop_duration`](Self::stop_duration), and stays there.
typedef struct {
  // Largest peak of the drive, N or V.
  double drive;
  // Largest displacement to either side, m.
  double stroke;
  // Largest contact force, N.
  double contact_force;
  // Largest force of the exciter, N.
  double force;
  // Longest time without a finite sample of force and response, s.
  double silence;
  // Time in which the drive goes to zero in an emergency, s; zero: at the next sample.
  double stop_duration;
} nlmodes_Limits;

// Linear modes at the motion sensors: rows of `Φ⁺`, by which the displacements at the sensors become modal
// coordinates, and what the damping of each mode takes.
//
// ```text
// η_k = Σ_d Φ⁺_kd x_d ,   xᴴ C x = Σ_k 2 ζ_k ω_k |η_k|²
// ```
typedef struct {
  size_t sensors;
  size_t modes;
  double rows[nlmodes_MAX_MODES][nlmodes_MAX_SENSORS];
  // `2 ζ_k ω_k`, 1/s.
  double losses[nlmodes_MAX_MODES];
} nlmodes_ModalFilter;

// Everything that the control of the force's higher harmonics has to know.
typedef struct {
  // Harmonics that are controlled, 2 to this one; the fundamental is that of the phase-locked loop.
  size_t harmonics;
  // Linear modes at the motion sensors, with their damping: what a linear modal test before gives.
  nlmodes_ModalFilter modes;
  // What each of these sensors measures; those beyond the last sensor mean nothing.
  nlmodes_ResponseQuantity quantities[nlmodes_MAX_SENSORS];
  // Index of the drive point.
  size_t drive;
  // Sampling interval, s.
  double step;
  // Cut-off `ω_c` of the detectors, rad/s.
  double cut_off;
  // Rate `κ` at which the drive follows, 1/s: slower than the detectors.
  double rate;
  // Largest amplitude of a harmonic of the force, as a share of its fundamental.
  double largest;
} nlmodes_AppropriationSettings;

// Force appropriation in the loop: harmonics of the force beyond the first that put into each harmonic of the motion
// the power which the linear damping takes out of it.
//
// ```text
// η_n = Φ⁺ x_n                                            modal coordinates, from all motion sensors
// F*_n = iν Σ_k 2 ζ_k ω_k |η_k,n|² / X̄_n ,   ν = nω        in phase with the velocity of the drive point, n = 2 … N_c
// U̇_n = κ (F*_n − F_n) / G_n                               drive, U = Re Σ U_n e^{inθ}
// ```
//
// `X_n` is the displacement of the drive point, `F_n` the measured force and `G_n` how the force answers to the drive,
// N or N/V, measured beforehand with the exciter on the structure. With `N_c = 1` there is the phase-locked loop
// alone, under which a force sensor shows whatever harmonics the exciter has.
//
// At a drive point without motion in harmonic `n`, `F*_n` is unbounded; it is then limited to the largest permitted
// one, and the state [indicates this](AppropriationState::is_limited). Shapes and units: amplitudes in SI units, one
// per harmonic.
typedef struct {
  nlmodes_AppropriationSettings settings;
  // `G_n`, with one for the fundamental.
  nlmodes_complex transfer[nlmodes_MAX_HARMONICS];
  // Share of an error by which a detector moves in a step.
  double rate;
} nlmodes_ForceAppropriation;

// A test under control: phase, amplitude, higher harmonics, levels and limits, with checked settings.
//
// Within a sampling interval the drive is `Re Σ U_n e^{inθ}` with amplitudes that change linearly. For a converter
// that holds its value, [`TestOutput::drive`] is that of the next sample.
typedef struct {
  nlmodes_PreparedLoop phase;
  nlmodes_AmplitudeSettings amplitude;
  nlmodes_LevelSchedule schedule;
  nlmodes_Limits limits;
  nlmodes_ForceAppropriation harmonics;
  bool controls_harmonics;
} nlmodes_loop;

// Least mean squares estimate of the mean and of the leading harmonics of one signal.
//
// ```text
// ε   = y − Y_0 − Re Σ_n Y_n e^{inθ}
// Y_n ← Y_n + 2 μ ε e^{−inθ} ,   Y_0 ← Y_0 + μ ε
// ```
//
// Each amplitude follows through a first-order low-pass with `μ = 1 − e^{−ω_c h}` a step; a signal that consists of
// these harmonics leaves `ε = 0`, and so no ripple, neither from the double frequency nor from a mean value.
typedef struct {
  double mean;
  nlmodes_complex amplitudes[nlmodes_MAX_HARMONICS];
} nlmodes_AdaptiveState;

// Synchronous demodulation of one signal: `2 y e^{−iθ}` through a low-pass.
typedef struct {
  nlmodes_complex amplitude;
  nlmodes_complex filter[2];
} nlmodes_DemodulationState;

// What a detector remembers of force and response.
typedef enum {
  NLMODES_DETECTOR_STATE_ADAPTIVE,
  NLMODES_DETECTOR_STATE_DEMODULATION,
} nlmodes_DetectorState_Tag;

typedef struct {
  nlmodes_AdaptiveState force;
  nlmodes_AdaptiveState response;
} nlmodes_DetectorState_nlmodes_Adaptive_Body;

typedef struct {
  nlmodes_DemodulationState force;
  nlmodes_DemodulationState response;
} nlmodes_DetectorState_nlmodes_Demodulation_Body;

typedef struct {
  nlmodes_DetectorState_Tag tag;
  union {
    nlmodes_DetectorState_nlmodes_Adaptive_Body ADAPTIVE;
    nlmodes_DetectorState_nlmodes_Demodulation_Body DEMODULATION;
  };
} nlmodes_DetectorState;

// What a loop remembers from one sample to the next: a value, without anything on the heap.
typedef struct {
  double theta;
  double omega;
  double integral;
  double lag;
  // Zero where it is not measurable.
  double error;
  double within;
  bool measurable;
  bool locked;
  bool held;
  bool at_limit;
  nlmodes_DetectorState detector;
} nlmodes_LoopState;

// What the control of the harmonics remembers from one sample to the next.
typedef struct {
  size_t harmonics;
  nlmodes_AdaptiveState force;
  nlmodes_AdaptiveState motions[nlmodes_MAX_SENSORS];
  // Work space for the displacements at the sensors in one harmonic.
  nlmodes_complex motion[nlmodes_MAX_SENSORS];
  nlmodes_complex drive[nlmodes_MAX_HARMONICS];
  nlmodes_complex wanted[nlmodes_MAX_HARMONICS];
  bool limited[nlmodes_MAX_HARMONICS];
  bool held;
} nlmodes_AppropriationState;

// Means over a window, or sums while it lasts.
typedef struct {
  double lag_error;
  double omega;
  double response;
  double deviation;
  // Of the periods of a window, and what noise would give.
  double spread;
  double spread_noise;
  // Of the controlled harmonics, over a window.
  double harmonic_error;
} nlmodes_Means;

// Fundamentals of force and response over each single period, and how far they lie apart.
//
// ```text
// Z_p = ∫_p y e^{−iθ} dθ                                  over the period p, by the trapezoidal rule between samples
// spread² = Σ_p |Z_p − Z̄|² / (P |Z̄|²)                    the larger one of force and response
// noise² = 4 σ² / (N |Z̄/π|²) ,  σ² = Σ (Δ⁴y)² / 70 N              what white noise adds to it, N samples a period
// ```
//
// Motions of several periods and those of two frequencies are seen, for neither repeats itself after one period. The
// noise is that of the quietest quarter of the period, without the impacts.
typedef struct {
  // Integrals over the period that is under way.
  nlmodes_complex now[2];
  // Whether no sample of it is missing.
  bool whole;
  // Phase of the last sample, and the signals there times `e^{−iθ}`.
  double theta;
  nlmodes_complex last[2];
  // Sums over the periods.
  nlmodes_complex sum[2];
  double squares[2];
  uint64_t count;
  // The last samples, and sums of squared fourth differences over each quarter of the period.
  double before[4][2];
  double bends[4][2];
  uint64_t in_quarter[4];
} nlmodes_Periods;

// The last windows of a level, and the one that is being filled.
typedef struct {
  nlmodes_Means sum;
  nlmodes_complex missing[nlmodes_MAX_HARMONICS];
  uint64_t samples;
  // Those of them that were measured.
  uint64_t measured;
  nlmodes_Periods single;
  // Beginnings of periods since the hold began: the first window begins with the first.
  size_t periods;
  nlmodes_Means last[nlmodes_MAX_WINDOWS];
  size_t count;
} nlmodes_Windows;

// How steady the last windows are; all zero before there are enough of them.
typedef struct {
  // Mean deviation of the lag from its target, rad.
  double lag_error;
  // Its standard error, rad.
  double lag_noise;
  // Relative drift of the frequency, 1/s.
  double frequency_drift;
  // Its standard error, 1/s.
  double frequency_noise;
  // Relative drift of the response, 1/s.
  double amplitude_drift;
  // Its standard error, 1/s.
  double amplitude_noise;
  // Relative deviation of a controlled amplitude from its level.
  double amplitude_deviation;
  // Its standard error.
  double deviation_noise;
  // Largest root mean square difference of the periods of a window from their mean, relative.
  double spread;
  // What white noise of the sensors makes of it.
  double spread_noise;
  // Largest mean deviation of a controlled harmonic of the force over the last window, relative to the fundamental.
  double harmonic_error;
  // Windows that this is from; none: nothing can be said yet.
  size_t windows;
  // Whether there are enough of them, and all is within tolerance and noise.
  bool settled;
} nlmodes_Drifts;

// Where in its schedule a test is.
typedef struct {
  nlmodes_Stage stage;
  // Index of the level, from zero.
  size_t level;
  // Samples in this stage.
  uint64_t samples;
  // Level at the beginning of a ramp.
  double from;
  // Level that is wanted now.
  double wanted;
  nlmodes_Windows windows;
  nlmodes_Drifts drifts;
  // Whether the level that is recorded was steady.
  bool settled;
} nlmodes_ScheduleState;

// What a test remembers from one sample to the next.
typedef struct {
  nlmodes_LoopState phase;
  nlmodes_AppropriationState harmonics;
  nlmodes_ScheduleState schedule;
  // Amplitudes of the drive at the last sample.
  nlmodes_complex amplitudes[nlmodes_MAX_HARMONICS];
  // Amplitudes when an emergency began.
  nlmodes_complex stopped_from[nlmodes_MAX_HARMONICS];
  nlmodes_EmergencyReason stop_reason;
  // Time without finite samples, s.
  double silent;
  // Phase of the sample before, for the beginnings of periods.
  double phase_before;
  bool drive_at_limit;
  // Error of a controlled amplitude at the last sample.
  double amplitude_error;
} nlmodes_loop_state;

// The samples of an instant.
typedef struct {
  // Force of the exciter, N.
  double force;
  // Response of the loop, in its unit.
  double response;
  // Displacement for the limit of the stroke, m; without that limit of no account.
  double stroke;
  // Contact force for its limit, N; without that limit of no account.
  double contact_force;
  // Motions for the control of harmonics, one a sensor; without it of no account.
  double motions[nlmodes_MAX_SENSORS];
  // Other than zero if the operator wants the test to end.
  uint32_t stop;
} nlmodes_loop_input;

// What to drive with until the next sample, and how the test goes.
typedef struct {
  // Drive at the next sample, N or V: to be given out when that is read.
  double drive;
  // Complex amplitudes `U_n` of the harmonics 1, 2 … at this sample and at the next, N or V.
  nlmodes_complex amplitudes[2][nlmodes_MAX_HARMONICS];
  // Phase `θ` of this sample, rad.
  double phase;
  // Angular frequency until the next, rad/s.
  double omega;
  // Measured lag of the response behind the force, rad.
  double lag;
  // Amplitude of the fundamental of the force, N.
  double force;
  // Amplitude of the fundamental of the response, in its unit.
  double response;
  // Level that is wanted at the next sample.
  double level;
  // Its index in the schedule, from zero; the number of levels after the last.
  size_t level_index;
  // What the test does.
  nlmodes_Stage stage;
  // Why it was ended.
  nlmodes_EmergencyReason stop_reason;
  // How steady the level is.
  nlmodes_Drifts drifts;
  // Whether the lag has been within its tolerance for the required time.
  bool locked;
  // Whether this sample belongs to the record of a level.
  bool recorded;
  // Whether the level that is recorded had settled.
  bool settled;
  // Whether the frequency is at an end of its range.
  bool frequency_at_limit;
  // Whether the drive would have to be larger than its limit.
  bool drive_at_limit;
} nlmodes_loop_output;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Fills in defaults for a resonance (rad/s, damping ratio, both roughly), a frequency at the start (rad/s) and a
// sampling interval (s). There are no levels yet.
nlmodes_SettingsRefusal nlmodes_loop_default_settings(nlmodes_loop_settings *settings,
                                                      double resonance_rad_s,
                                                      double damping_ratio,
                                                      double start_rad_s,
                                                      double step_s);

// Checks the settings and makes a test of them: before the real-time task begins.
nlmodes_SettingsRefusal nlmodes_loop_prepare(const nlmodes_loop_settings *settings,
                                             nlmodes_loop *control);

// The state before the first sample.
nlmodes_SettingsRefusal nlmodes_loop_start(const nlmodes_loop *control, nlmodes_loop_state *state);

// One sample: reads `input`, moves `state` on, writes `output`. The same arguments give the same bits.
nlmodes_SettingsRefusal nlmodes_loop_step(const nlmodes_loop *control,
                                          nlmodes_loop_state *state,
                                          const nlmodes_loop_input *input,
                                          nlmodes_loop_output *output);

// The same for programs that pass numbers and arrays, and no structures; without controlled harmonics. Writes drive at
// the next sample, angular frequency (rad/s), phase (rad), lag (rad), amplitudes of force (N) and response, level and
// its index, stage, stop reason, and 1 or 0 for `recorded` and `settled`.
nlmodes_SettingsRefusal nlmodes_loop_step_flat(const nlmodes_loop *control,
                                               nlmodes_loop_state *state,
                                               double force_n,
                                               double response,
                                               double stroke_m,
                                               double contact_force_n,
                                               uint32_t stop,
                                               double (*output)[nlmodes_FLAT_LENGTH]);

// Bytes of `nlmodes_loop_settings`, `nlmodes_loop`, `nlmodes_loop_state`, `nlmodes_loop_input` and
// `nlmodes_loop_output`, for programs that allocate them by their size; each is aligned to 8 bytes.
nlmodes_SettingsRefusal nlmodes_loop_sizes(size_t (*sizes)[5]);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* NLMODES_LOOP_H */
