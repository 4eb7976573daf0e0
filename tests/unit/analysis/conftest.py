def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes long; ctest has it as a label too")
