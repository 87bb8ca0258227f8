from course_lib.grading.run.submission_run import Budget


def test_task_may_use_its_own_share_and_the_common_budget() -> None:
    shares = Budget(40.0, ("a", "b"))
    shares.charge("a", 12.0)
    assert (shares.remaining("a"), shares.remaining("b")) == (18.0, 28.0)
    shares.charge("a", 99.0)
    assert (shares.remaining("a"), shares.remaining("b")) == (0.0, 10.0)


def test_tasks_together_do_not_exceed_the_total_budget() -> None:
    shares = Budget(30.0, ("a", "b", "c"))
    taken = 0.0
    for task in "abc" * 5:
        most = min(shares.remaining(task), 4.0)
        shares.charge(task, most)
        taken += most
    assert taken == 30.0
