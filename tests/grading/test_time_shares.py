from course_lib.grading.run.submission_run import TimeShares


def test_a_task_takes_its_own_part_and_all_that_is_common() -> None:
    shares = TimeShares(40.0, ("a", "b"))
    shares.take("a", 12.0)
    assert (shares.left("a"), shares.left("b")) == (18.0, 28.0)
    shares.take("a", 99.0)
    assert (shares.left("a"), shares.left("b")) == (0.0, 10.0)


def test_all_tasks_together_take_no_more_than_the_whole() -> None:
    shares = TimeShares(30.0, ("a", "b", "c"))
    taken = 0.0
    for task in "abc" * 5:
        most = min(shares.left(task), 4.0)
        shares.take(task, most)
        taken += most
    assert taken == 30.0
