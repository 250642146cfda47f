// Turning and approaching what is seen: mouse, touch, wheel, keys.

const [NEAREST, FARTHEST] = [1.2, 40];
const DEGREES_A_PIXEL = 0.4;
const DEGREES_A_KEY = 5;

// `view`: turn, height_angle [degrees], distance; `changed()` is called when it is another one.
export function orbit(canvas, view, changed) {
  const pointers = new Map();

  const turn = (dx, dy) => {
    view.turn = ((view.turn + dx + 540) % 360) - 180;
    view.height_angle = Math.min(89, Math.max(-89, view.height_angle + dy));
    changed();
  };
  const approach = (factor) => {
    view.distance = Math.min(FARTHEST, Math.max(NEAREST, view.distance * factor));
    changed();
  };
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = pointers.size === 2 ? spread() : 0;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) turn(DEGREES_A_PIXEL * dx, DEGREES_A_PIXEL * dy);
    else if (before > 0 && spread() > 0) approach(before / spread());
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      approach(Math.exp(Math.sign(event.deltaY) * 0.1));
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
