"""A program that looks after a robot: it notices stops and starts the robot again. It knows nothing of the simulator."""

import time

import dashboard_client
import rtde_receive

PROTECTIVE_STOP, EMERGENCY_STOP = 3, 7
OFF, RUNNING = 3, 7


class Watcher:
    """Looks after the robot at an address."""

    def __init__(self, host: str) -> None:
        self._robot = rtde_receive.RTDEReceiveInterface(host, 125.0)
        self._dashboard = dashboard_client.DashboardClient(host)
        self._dashboard.connect()

    def close(self) -> None:
        """Leave it alone."""
        self._robot.disconnect()
        self._dashboard.disconnect()

    @property
    def running(self) -> bool:
        """It can work."""
        return self._robot.getRobotMode() == RUNNING and self._robot.getSafetyMode() not in (PROTECTIVE_STOP, EMERGENCY_STOP)

    def wait_stopped(self, seconds: float) -> bool:
        """Whether it stops within some time."""
        end = time.monotonic() + seconds
        while self.running and time.monotonic() < end:
            time.sleep(0.01)
        return not self.running

    def recover(self, seconds: float) -> bool:
        """Bring it back to work: unlock a protective stop, switch on drives that are off. Whether it works within some time."""
        end = time.monotonic() + seconds
        while not self.running and time.monotonic() < end:
            try:
                if self._robot.getSafetyMode() == PROTECTIVE_STOP:
                    self._dashboard.unlockProtectiveStop()
                elif self._robot.getRobotMode() == OFF:
                    self._dashboard.powerOn()
                    self._dashboard.brakeRelease()
            except RuntimeError:  # it is too early
                pass
            time.sleep(0.1)
        return self.running
