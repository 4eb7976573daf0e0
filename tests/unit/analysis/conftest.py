import gc


def pytest_configure(config):
    gc.set_threshold(100_000)  # a picture is made of many small objects: looking for garbage took a fifth of its time
    config.addinivalue_line("markers", "slow: takes long; ctest has it as a label too")
