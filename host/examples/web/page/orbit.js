// Turning and approaching what is seen: mouse, touch, wheel, keys.

const [NEAREST, FARTHEST] = [1.2, 40];
const DEGREES_A_PIXEL = 0.4;
const DEGREES_A_KEY = 5;

const within = (x, low, high) => Math.min(high, Math.max(low, x));

// The nearest view that can be had: all around, but never from right above or below, where left and right are nowhere.
export function limited({ turn, height_angle, distance }) {
  return {
    turn: ((((turn + 180) % 360) + 360) % 360) - 180,
    height_angle: within(height_angle, -89, 89),
    distance: within(distance, NEAREST, FARTHEST),
  };
}

// `view`: turn, height_angle [degrees], distance; `changed()` is called when it is another one.
export function orbit(canvas, view, changed) {
  const pointers = new Map();

  const move = (next) => {
    const there = limited({ ...view, ...next });
    if (Object.keys(there).every((name) => there[name] === view[name])) return;
    Object.assign(view, there);
    changed();
  };
  const turn = (dx, dy) => move({ turn: view.turn + dx, height_angle: view.height_angle + dy });
  const approach = (factor) => move({ distance: view.distance * factor });
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = pointers.size === 2 ? spread() : 0;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) turn(-DEGREES_A_PIXEL * dx, DEGREES_A_PIXEL * dy);
    else if (before > 0 && spread() > 0) approach(before / spread());
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * [1, 20, 400][event.deltaMode]; // they may be lines, or pages
      approach(Math.exp(0.001 * within(pixels, -400, 400)));
    },
    { passive: false },
  );
  const keys = {
    ArrowLeft: () => turn(-DEGREES_A_KEY, 0),
    ArrowRight: () => turn(DEGREES_A_KEY, 0),
    ArrowUp: () => turn(0, DEGREES_A_KEY),
    ArrowDown: () => turn(0, -DEGREES_A_KEY),
    "+": () => approach(1 / 1.1),
    "=": () => approach(1 / 1.1),
    "-": () => approach(1.1),
  };
  canvas.addEventListener("keydown", (event) => {
    const act = event.ctrlKey || event.metaKey || event.altKey ? undefined : keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
