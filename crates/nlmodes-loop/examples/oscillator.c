/* A phase-resonance test of an oscillator with a stop, through the C interface of the loop.
 *
 * The oscillator is integrated here; at a rig its place is taken by the converters. The drive is held between two
 * samples, as a digital-to-analogue converter holds it, and the sensors have noise. `oscillator.rs` is the same program
 * in Rust: `.ci/loop` compares what both print, bit for bit.
 *
 *     cc -std=c11 -ffp-contract=off -I include examples/oscillator.c libnlmodes_loop.a -Wl,--gc-sections
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "nlmodes_loop.h"

static const double RATE_HZ = 10000.0;
static const int SUBSTEPS = 16;

/* 1 kg at 40 Hz with 1 % damping, and a stop of 50 kN/m behind 1 mm. */
static const double OMEGA = 251.32741228718345, DAMPING = 0.01, GAP_M = 1e-3, STOP_N_M = 5e4;

typedef struct {
  double x_m, v_m_s;
  uint64_t seed;
} rig;

static double contact_force(const rig *r) { return r->x_m > GAP_M ? STOP_N_M * (r->x_m - GAP_M) : 0.0; }

static void advance(rig *r, double force_n) {
  const double h = 1.0 / RATE_HZ / SUBSTEPS;
  for (int k = 0; k < SUBSTEPS; ++k) {
    r->v_m_s += h * (force_n - contact_force(r) - 2.0 * DAMPING * OMEGA * r->v_m_s - OMEGA * OMEGA * r->x_m);
    r->x_m += h * r->v_m_s;
  }
}

/* Between -1 and 1. */
static double noise(rig *r) {
  r->seed = r->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(r->seed >> 11) / 4503599627370496.0 - 1.0;
}

static uint64_t bits(double x) {
  uint64_t u;
  memcpy(&u, &x, sizeof u);
  return u;
}

/* Runs a test to its end; prints the end of each record and of the test. */
static int run(const char *name, const nlmodes_loop_settings *settings) {
  static nlmodes_loop loop; /* some kilobytes: static, for small stacks */
  static nlmodes_loop_state state;
  nlmodes_loop_input input;
  nlmodes_loop_output output;
  memset(&input, 0, sizeof input);
  nlmodes_SettingsRefusal refused = nlmodes_loop_prepare(settings, &loop);
  if (refused != NLMODES_SETTINGS_REFUSAL_NONE) {
    printf("%s: refused, code %d\n", name, (int)refused);
    return 1;
  }
  nlmodes_loop_start(&loop, &state);
  rig r = {0.0, 0.0, 1};
  double drive_n = 0.0;
  uint64_t sum = UINT64_C(14695981039346656037);
  bool recorded = false;
  long samples = 0;
  do {
    input.force = drive_n + 1e-3 * noise(&r);
    input.response = r.x_m + 1e-7 * noise(&r);
    input.stroke = input.response;
    input.contact_force = contact_force(&r);
    nlmodes_loop_step(&loop, &state, &input, &output);
    const double seen[] = {output.drive, output.omega, output.phase, output.lag, output.response};
    for (int k = 0; k < 5; ++k) {
      sum = (sum ^ bits(seen[k])) * UINT64_C(1099511628211);
    }
    if (recorded && !output.recorded) {
      printf("%s: level %d, %.4f Hz, lag %.3f degrees, %.4f N, %.6f mm, settled %d, bits %016" PRIx64 "\n", name,
             (int)output.level_index, output.omega / 6.283185307179586, output.lag * 57.29577951308232, output.force,
             1e3 * output.response, (int)output.settled, bits(output.omega));
    }
    recorded = output.recorded;
    advance(&r, drive_n);
    drive_n = output.drive;
    ++samples;
  } while (output.stage != NLMODES_STAGE_FINISHED && output.stage != NLMODES_STAGE_STOPPED);
  printf("%s: stage %d, stop reason %d, %ld samples, sum %016" PRIx64 "\n", name, (int)output.stage,
         (int)output.stop_reason, samples, sum);
  return 0;
}

int main(void) {
  static nlmodes_loop_settings settings;
  nlmodes_loop_default_settings(&settings, OMEGA, DAMPING, OMEGA - 1.5, 1.0 / RATE_HZ);
  settings.lock_duration_s = 0.2;
  settings.window_periods = 10;
  settings.record_s = 0.5;

  /* Levels are forces; the stop is touched from the third on. */
  const double forces_n[] = {0.4, 0.8, 1.4, 2.0};
  memcpy(settings.levels, forces_n, sizeof forces_n);
  settings.level_count = 4;
  int failed = run("force", &settings);

  /* Levels are displacements: stepped response. */
  const double displacements_m[] = {0.6e-3, 1.02e-3};
  memcpy(settings.levels, displacements_m, sizeof displacements_m);
  settings.level_count = 2;
  settings.controlled = 2;
  settings.smallest_drive = 0.05;
  settings.largest_drive = 4.0;
  failed |= run("response", &settings);

  /* A contact force above its limit ends the test. */
  settings.largest_contact_force_n = 1.0;
  failed |= run("emergency", &settings);
  return failed;
}
