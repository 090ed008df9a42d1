// Frame ranges as text ("0-99x10,140"), and back.

export function parseRange(text) {
  const numbers = [];
  for (const part of text.split(",")) {
    const match = /^(-?\d+)(?:-(-?\d+)(?:x(\d+))?)?$/.exec(part.trim());
    if (!match) throw new Error(`a range is written "1-100x2,140", not "${part}"`);
    const first = Number(match[1]), last = match[2] === undefined ? first : Number(match[2]),
      step = Number(match[3] ?? 1);
    for (let i = 0; step > 0 && i <= Math.abs(last - first); i += step) numbers.push(first + (last < first ? -i : i));
  }
  return numbers;
}

// Consecutive frames become one part; `numbers` ascend.
export function formatRange(numbers) {
  const parts = [];
  for (let i = 0; i < numbers.length;) {
    let end = i;
    while (end + 1 < numbers.length && numbers[end + 1] === numbers[end] + 1) end++;
    parts.push(end === i ? `${numbers[i]}` : `${numbers[i]}-${numbers[end]}`);
    i = end + 1;
  }
  return parts.join(",");
}
