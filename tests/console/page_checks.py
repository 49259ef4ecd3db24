"""What holds of every view, computed inside the page: contrast, names, focus, nothing that sticks out."""

# WCAG 2.1, 1.4.3: text against the nearest opaque background; 4.5, or 3 where it is large. Returns what falls short.
CONTRAST = """(() => {
  const paint = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  const parse = (css) => { paint.clearRect(0, 0, 1, 1); paint.fillStyle = css; paint.fillRect(0, 0, 1, 1);
                           const d = paint.getImageData(0, 0, 1, 1).data; return [d[0], d[1], d[2], d[3] / 255]; };
  const light = (rgb) => { const [r, g, b] = rgb.map((c) => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; });
                           return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const under = (element) => { for (let e = element; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c[3] > 0.7) return c; }
                               return [255, 255, 255, 1]; };
  const poor = [];
  const walker = document.createTreeWalker(document.querySelector('dialog[open]') ?? document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement, text = walker.currentNode.textContent.trim();
    if (!text || !element.checkVisibility({ visibilityProperty: true, opacityProperty: true }) || element.closest(':disabled, title, option')) continue;
    const style = getComputedStyle(element);
    const [a, b] = [light(parse(style.color).slice(0, 3)), light(under(element).slice(0, 3))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
    if (ratio < (large ? 3 : 4.5)) poor.push(`${text.slice(0, 40)}: ${ratio.toFixed(2)}`);
  }
  return poor;
})()"""

# Everything one can operate has a name for those who cannot see it.
NAMELESS = """[...document.querySelectorAll('button, a[href], input, select, textarea, [role=application], [role=img]')]
  .filter((e) => e.checkVisibility() && !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length || e.title))
  .map((e) => e.outerHTML.slice(0, 120))"""

STICKS_OUT = "Math.max(document.documentElement.scrollWidth, document.body.scrollWidth) - innerWidth"

# The focused element shows that it is: an outline of its own, or its label's.
FOCUS_SEEN = """(() => { const e = document.activeElement;
  const seen = [e, e.closest('label')].some((one) => one && getComputedStyle(one).outlineStyle !== 'none' && parseFloat(getComputedStyle(one).outlineWidth) >= 2);
  return seen ? '' : e.outerHTML.slice(0, 160); })()"""


async def hold(page, where):
    """Asserts everything above for what the page shows now."""
    poor = await page.run(CONTRAST)
    assert not poor, f"{where}: contrast below WCAG AA: {poor}"
    nameless = await page.run(NAMELESS)
    assert not nameless, f"{where}: controls without a name: {nameless}"
    assert await page.run(STICKS_OUT) <= 0, f"{where}: sticks out of the screen by {await page.run(STICKS_OUT)} px"
