// What plays a period: a button, a slider of the phase, and a clock.

class Player {
  /// Puts its controls into the box, and calls `draw` whenever something is to be drawn anew.
  constructor(box, draw) {
    Object.assign(this, { box, draw, phase: 0, speed: 1, last: null });
    this.button = html(box, "button", { type: "button", class: "play" });
    this.button.addEventListener("click", () => this.play(!this.playing));
    this.phases = this.slider("phase", { min: 0, max: 360, step: 1, value: 0, class: "phase" }, degrees => { this.play(false); this.phase = degrees / 360; });
    this.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    requestAnimationFrame(now => this.tick(now));
  }

  slider(name, attributes, act) {
    const input = html(html(this.box, "label", {}, name + " "), "input", { type: "range", ...attributes });
    input.addEventListener("input", () => { act(Number(input.value)); this.draw(); });
    return input;
  }

  play(playing) {
    this.playing = playing;
    this.button.textContent = playing ? "❚❚ Pause" : "▶ Play";
    this.button.setAttribute("aria-pressed", String(playing));
  }

  tick(now) {
    // A period in three seconds at normal speed.
    if (this.playing && this.last !== null) {
      this.phase = (this.phase + this.speed * Math.min(0.1, (now - this.last) / 1000) / 3) % 1;
      this.phases.value = Math.round(360 * this.phase) % 360;
      this.draw();
    }
    this.last = now;
    requestAnimationFrame(next => this.tick(next));
  }
}
