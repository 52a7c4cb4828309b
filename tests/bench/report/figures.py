"""Figures as people read them: rates, spreads, tables."""


def digits(value):
    """Three digits, but no more than are before the point: 0.0312, 4.51, 62.7, 1,240."""
    if value == 0:
        return "0"
    if abs(value) >= 100:
        return minus(f"{value:,.0f}")
    return minus(f"{value:#.3g}" if abs(value) < 99.95 else f"{value:.0f}")


def minus(text):
    """With the sign that is as wide as a plus."""
    return text.replace("-", "−")


def with_spread(spread, scale=1.0):
    """12.3 (11.9 – 12.8)"""
    return f"{digits(spread['median'] * scale)} ({digits(spread['min'] * scale)} – {digits(spread['max'] * scale)})"


def count(number):
    return f"{number:,}"


def megabytes(number):
    return digits(number / 1e6)


def table(heading, rows):
    if not rows:
        return "*Not measured in this run.*"
    lines = [heading, ["---"] * len(heading), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)
