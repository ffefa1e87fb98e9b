// What is drawn over the picture: the units that workers have, and the pixel under the cursor.

function hue(text) {
  let sum = 0;
  for (const letter of text) sum = (31 * sum + letter.charCodeAt(0)) % 360;
  return sum;
}

// `place`: of the corner of the picture on the stage; `scale`: of its pixels.
export function drawUnits(context, units, frame, place, scale) {
  const unitScale = scale / frame.step;
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "top";
  for (const unit of units) {
    const x = place.x + (unit.x0 - frame.x0) * unitScale, y = place.y + (unit.y0 - frame.y0) * unitScale;
    const width = (unit.x1 - unit.x0) * unitScale, height = (unit.y1 - unit.y0) * unitScale;
    const color = `hsl(${hue(unit.worker)} 90% 60%)`;
    context.strokeStyle = color;
    context.lineWidth = unit.running ? 2 : 1;
    context.setLineDash(unit.running ? [] : [3, 3]);
    context.strokeRect(x + 1, y + 1, Math.max(width - 2, 1), Math.max(height - 2, 1));
    if (width < 44 || !unit.running) continue;
    context.fillStyle = "rgb(0 0 0 / 60%)";
    const text = unit.worker_name || unit.worker.slice(0, 6);
    context.fillRect(x + 2, y + 2, Math.min(context.measureText(text).width + 6, width - 4), 14);
    context.fillStyle = color;
    context.fillText(text, x + 5, y + 3, width - 8);
  }
}

// `point`: the middle of the pixel on the stage.
export function markPixel(context, point, scale) {
  for (const [color, width] of [["#000", 3], ["#fff", 1]]) {
    context.strokeStyle = color;
    context.lineWidth = width;
    context.strokeRect(point.x - scale / 2, point.y - scale / 2, scale, scale);
  }
}
