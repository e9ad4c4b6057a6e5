"""Agents that do what an agent must not do, each in one way; played from this file, in processes of their own."""

import os
import sys
import time

import numpy as np

from antgym.tuning import incumbent


class Honest:
    """Random settings in threes, then the best."""

    def reset(self, task, *, seed):
        self.task, self.rng, self.seen = task, np.random.default_rng(seed), []

    def ask(self):
        return self.rng.random((3, len(self.task.space)))

    def tell(self, trials):
        self.seen += trials

    def recommend(self):
        return np.array(incumbent(self.seen)[0]) if self.seen else np.full(len(self.task.space), 0.5)


class Whimsical(Honest):
    """Draws from nowhere."""

    def ask(self):
        return np.random.default_rng().random((3, len(self.task.space)))


class Wavers(Honest):
    """Recommends from nowhere."""

    def recommend(self):
        return np.random.default_rng().random(len(self.task.space))


class LosesHeart(Honest):
    """Has been at work before, and now asks for nothing."""

    def ask(self):
        return np.empty((0, len(self.task.space)))


class Overspends(Honest):
    def ask(self):
        return self.rng.random((1000, len(self.task.space)))


class Raises(Honest):
    def ask(self):
        raise KeyError("\x1b[31mred\nline " + "x" * 999)


class AnswersNaN(Honest):
    def recommend(self):
        return np.full(len(self.task.space), np.nan)


class AnswersWrongShape(Honest):
    def ask(self):
        return np.full((2, 7), 0.5)


class AnswersOutside(Honest):
    def ask(self):
        return np.full((1, len(self.task.space)), 3.0)


class AnswersText(Honest):
    def recommend(self):
        return "the best one"


class RecommendsTwo(Honest):
    def recommend(self):
        return np.full((2, len(self.task.space)), 0.5)


class AnswersTooMuch(Honest):
    def ask(self):
        return self.rng.random((1 << 16, len(self.task.space)))


class HangsAwake(Honest):
    def ask(self):
        while True:
            pass


class HangsAsleep(Honest):
    def tell(self, trials):
        time.sleep(3600)


class HangsAtBirth:
    def __init__(self):
        time.sleep(3600)


class Dies(Honest):
    def ask(self):
        os._exit(3)


class IsKilled(Honest):
    def recommend(self):
        os.kill(os.getpid(), 9)


class Exits(Honest):
    def ask(self):
        sys.exit("goodbye")


class EatsMemory(Honest):
    def ask(self):
        return np.zeros((1 << 28, len(self.task.space)))


class PlansItself(Honest):
    def ask(self):
        from antgym.planners.planning import plan_many

        return plan_many


class MakesAnEnvironment(Honest):
    def reset(self, task, *, seed):
        import gymnasium

        import antgym  # noqa: F401

        gymnasium.make("antgym/MountainOneShot-v0")


class ReadsTheBoard(Honest):
    def reset(self, task, *, seed):
        from experiments.contest import enter

        enter([], None, {})


class Forges(Honest):
    """Changes what it was told, in the hope that the harness reads it back."""

    def tell(self, trials):
        trials = [trial._replace(cost=0.0) for trial in trials]
        super().tell(trials)


class Peeks(Honest):
    """Fails with the names of all that it can see, for a test to read."""

    def tell(self, trials):
        raise ValueError(" ".join([*trials[0]._fields, *vars(self.task)]))


class Remembers(Honest):
    """Recommends what an earlier run of the same class left behind, were it there."""

    left = 0.25

    def recommend(self):
        found, Remembers.left = Remembers.left, 0.75
        return np.full(len(self.task.space), found)


class Prints(Honest):
    def ask(self):
        print('{"shape": [1, 4], "values": [0, 0, 0, 0]}')
        return super().ask()


class LooksAtTheMap(Honest):
    def recommend(self):
        flat, solid = self.task.map(True), self.task.map(flat=False)
        assert (flat.shape, solid.shape, flat.dtype) == ((3, 32, 32), (3, 16, 16, 16), np.float32)
        return np.full(len(self.task.space), solid[0].mean())


class Abandons(Honest):
    """Starts a process that would outlive it, and recommends its number."""

    def recommend(self):
        child = os.fork()
        if not child:
            time.sleep(3600)
        return np.full(len(self.task.space), child / 2**22)


class KillsTheNursery(Honest):
    def ask(self):
        os.kill(os.getppid(), 9)
        return super().ask()


class Computes(Honest):
    """Thinks for a tenth of a second in another thread."""

    def recommend(self):
        from threading import Thread

        def think():
            while time.process_time() < 0.1:
                pass

        thread = Thread(target=think)
        thread.start()
        thread.join()
        return super().recommend()
