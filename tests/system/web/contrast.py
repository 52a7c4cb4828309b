"""The contrast of colours after WCAG 2.2, and the tokens of a style sheet."""
import re


def tokens(sheet, selector):
    """The custom properties that are colours, of the first rule with this selector: {"--bg": (11, 12, 22), …}."""
    rule = re.search(re.escape(selector) + r"\s*\{(.*?)\}", sheet, re.S)[1]
    return {name: tuple(bytes.fromhex(colour)) for name, colour in re.findall(r"(--[\w-]+):\s*#([0-9a-fA-F]{6})\b",
                                                                              rule)}


def luminance(colour):
    """Relative luminance (https://www.w3.org/TR/WCAG22/#dfn-relative-luminance)."""
    red, green, blue = (share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4
                        for share in (channel / 255 for channel in colour))
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one, other):
    darker, lighter = sorted(map(luminance, (one, other)))
    return (lighter + 0.05) / (darker + 0.05)
