"""What differs from one unknown robot to the next, by its serial number."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Make:
    """One robot's own values; number 0 has three faults."""

    serial: int = 0

    @property
    def image_hz(self) -> float:
        """Images per second."""
        return 30.0 if self.serial == 0 else 10.0 + 3.0 * (self.serial % 7)

    @property
    def image_width(self) -> int:
        """Of an image, [px]."""
        return 64 if self.serial == 0 else 32 + 16 * (self.serial % 5)

    @property
    def scans_reliably(self) -> bool:
        """Whether scans that are lost are sent again."""
        return self.serial % 2 == 1

    @property
    def threshold(self) -> float:
        """How sure the detector has to be, 0 to 1."""
        return round(0.5 + 0.05 * (self.serial % 9), 2)
